// Two fingers on the picture.

const middle = ([a, b]) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
const spread = ([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1]);

// Two pairs of positions, before and now: how far their middle went, and how many times further
// apart they are.
export function pinch(before, now) {
  const [from, to] = [middle(before), middle(now)];
  const apart = spread(before) > 0 && spread(now) > 0 ? spread(now) / spread(before) : 1;
  return { dx: to[0] - from[0], dy: to[1] - from[1], ratio: apart };
}
