// Lines that scatter less.

// Each value becomes the mean over a window of `percent` of all points around it (cut at both ends);
// null where the window has none.
export function smoothed(values, percent) {
  const half = Math.round((values.length * percent) / 200);
  if (half === 0) return values;
  const sums = [0];
  const counts = [0];
  values.forEach((value, i) => {
    const there = Number.isFinite(value);
    sums.push(sums[i] + (there ? value : 0));
    counts.push(counts[i] + (there ? 1 : 0));
  });
  return values.map((_, i) => {
    const [low, high] = [Math.max(0, i - half), Math.min(values.length, i + half + 1)];
    const count = counts[high] - counts[low];
    return count > 0 ? (sums[high] - sums[low]) / count : null;
  });
}

// The value of a line at x; null outside of it.
export function valueAt(xs, ys, x) {
  const next = xs.findIndex((value) => value >= x);
  if (next < 0 || x < xs[0]) return null;
  if (next === 0 || xs[next] === x) return ys[next];
  const share = (x - xs[next - 1]) / (xs[next] - xs[next - 1]);
  return ys[next - 1] === null || ys[next] === null
    ? null
    : (1 - share) * ys[next - 1] + share * ys[next];
}
