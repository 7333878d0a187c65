// Keys of the page with the picture; those that are held, and the mouse, are controls.js'.

const nothing = () => {};
const kDigits = ["1", "2", "3", "4", "5", "6", "7", "8", "9"];

const kMotions = [
  { keys: ["w", "a", "s", "d"], help: "ahead, left, back, right", run: nothing },
  { keys: ["q", "e"], help: "down, up", run: nothing },
  {
    keys: ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"],
    help: "turn, or orbit",
    run: nothing,
  },
  { keys: [], shown: ["Shift"], help: "with these: faster", run: nothing },
  { keys: [], shown: ["left drag", "one finger"], help: "turn, or orbit", run: nothing },
  { keys: [], shown: ["right drag", "two fingers"], help: "move across", run: nothing },
  { keys: [], shown: ["wheel"], help: "distance, or speed", run: nothing },
  { keys: [], shown: ["pinch"], help: "nearer or further", run: nothing },
  { keys: [], shown: ["double click"], help: "sets the pivot", run: nothing },
];

export function viewerKeys(viewer) {
  const { app, path } = viewer;
  return [
    ...kMotions,
    { keys: ["o"], help: "fly or orbit", run: () => app.toggleMode() },
    { keys: ["l"], help: "level the horizon", run: () => app.level() },
    { keys: ["r"], help: "back to the first view", run: () => app.reset() },
    { keys: ["["], help: "view before", run: () => app.step(-1) },
    { keys: ["]"], help: "next view", run: () => app.step(1) },
    {
      keys: ["f"],
      help: "cameras of the views",
      run: () => app.set({ frusta: !app.state.frusta }),
    },
    {
      keys: kDigits,
      shown: ["1", "…", "9"],
      help: "layer",
      run: ({ key }) => app.setLayer(key - 1),
    },
    { keys: ["x"], help: "keys for the other side", run: () => app.toggleSide() },
    {
      keys: ["c"],
      help: "the photo beside",
      run: () => app.setRight(app.state.right ? null : "photo"),
    },
    { keys: ["k"], help: "add to the path", run: () => path.add() },
    { keys: ["p"], help: "play the path", run: () => path.player.toggle() },
    { keys: ["h"], help: "the panel", run: () => viewer.togglePanel() },
  ];
}
