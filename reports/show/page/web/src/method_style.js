// Colours and dashes of methods: Okabe and Ito's colours, which colour-blind readers tell apart, and
// a dash pattern and marker that carry the same information without colour.

const kLight = ["#0072b2", "#d55e00", "#00795b", "#b3548f", "#8a6d00", "#2b86c5", "#333333"];
const kDark = ["#56b4e9", "#ff9e4a", "#2fc69a", "#e59cc8", "#f0e442", "#9ad0f5", "#dddddd"];
// Five dashes and twelve markers beside seven colours: 35 methods differ in lines, 84 in points.
const kDashes = [[], [8, 4], [2, 3], [10, 3, 2, 3], [16, 5]];
const kMarkers = ["●", "■", "▲", "◆", "✚", "★", "▼", "○", "□", "△", "◇", "☆"];

export const isDark = () => document.documentElement.dataset.theme === "dark";

export function methodStyle(index) {
  const colors = isDark() ? kDark : kLight;
  return {
    color: colors[index % colors.length],
    dash: kDashes[index % kDashes.length],
    marker: kMarkers[index % kMarkers.length],
  };
}
