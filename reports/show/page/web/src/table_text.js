// A table as it is shown, as LaTeX, CSV and Markdown. model: {title, caption, notes, columns:
// [{title, group}], rows: [[{text, value, rank}]]}; the first column names the row.

const kLatex = {
  "\\": "\\textbackslash{}",
  "&": "\\&",
  "%": "\\%",
  $: "\\$",
  "#": "\\#",
  _: "\\_",
  "{": "\\{",
  "}": "\\}",
  "<": "$<$",
  ">": "$>$",
  "|": "$|$",
  "~": "$\\sim$",
  "^": "\\textasciicircum{}",
  "−": "$-$",
  "–": "--",
  "±": "$\\pm$",
  "≈": "$^\\approx$",
  "†": "$^\\dagger$",
  "°": "$^\\circ$",
  "↑": "$\\uparrow$",
  "↓": "$\\downarrow$",
  δ: "$\\delta$",
  τ: "$\\tau$",
};

export const latexText = (text) => [...String(text)].map((c) => kLatex[c] ?? c).join("");

const oneLine = (text) => String(text).replace(/\s+/g, " ");

function groupsOf(columns) {
  const groups = [];
  columns.forEach(({ group }, i) => {
    if (groups.at(-1)?.title === (group ?? "")) ++groups.at(-1).count;
    else groups.push({ title: group ?? "", first: i, count: 1 });
  });
  return groups;
}

function latexGroups(columns) {
  const groups = groupsOf(columns);
  if (groups.every(({ title }) => !title)) return [];
  const cells = groups.map(({ title, count }) =>
    title
      ? `\\multicolumn{${count}}{c}{${latexText(title)}}`
      : count > 1
        ? "& ".repeat(count - 1)
        : "",
  );
  const rules = groups
    .filter(({ title }) => title)
    .map(({ first, count }) => `\\cmidrule(lr){${first + 1}-${first + count}}`);
  return [`${cells.join(" & ")} \\\\`, rules.join("")];
}

function latexCell({ text, rank }) {
  const plain = latexText(text);
  if (rank === 1) return `\\textbf{${plain}}`;
  return rank === 2 ? `\\underline{${plain}}` : plain;
}

// A tabular for booktabs: best in bold, second underlined.
export function tableLatex({ title, caption, notes = [], columns, rows }) {
  const row = (cells) => `${cells.join(" & ")} \\\\`;
  return [
    `% ${oneLine(title)}${caption ? `. ${oneLine(caption)}` : ""}`,
    "% \\usepackage{booktabs}; best in bold, second underlined",
    `\\begin{tabular}{l${"c".repeat(columns.length - 1)}}`,
    "\\toprule",
    ...latexGroups(columns),
    row(columns.map((column) => latexText(column.title))),
    "\\midrule",
    ...rows.map((cells) => row(cells.map(latexCell))),
    "\\bottomrule",
    "\\end{tabular}",
    ...notes.map((note) => `% ${oneLine(note)}`),
    "",
  ].join("\n");
}

// Titles of columns; with their group where there are several.
function flatTitles(columns) {
  const several = new Set(columns.map(({ group }) => group).filter(Boolean)).size > 1;
  return columns.map(({ title, group }) => (several && group ? `${group}: ${title}` : title));
}

const csvField = (value) => {
  const text = String(value ?? "");
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
};

// Unrounded values; where there is none, what the table says in its place.
export function tableCsv({ columns, rows }) {
  const lines = [flatTitles(columns), ...rows.map((cells) => cells.map((c) => c.value ?? c.text))];
  return lines.map((line) => `${line.map(csvField).join(",")}\n`).join("");
}

const markdownText = (text) =>
  oneLine(text).replace(/[\\|<>*_`]/g, (c) => (c === "|" ? "\\|" : `\\${c}`));

function markdownCell({ text, rank }) {
  const plain = markdownText(text);
  if (rank === 1) return `**${plain}**`;
  return rank === 2 ? `<u>${plain}</u>` : plain;
}

// Best in bold, second underlined.
export function tableMarkdown({ title, columns, rows, notes = [] }) {
  const row = (cells) => `| ${cells.join(" | ")} |`;
  return [
    `**${markdownText(title)}**`,
    "",
    row(flatTitles(columns).map(markdownText)),
    row(columns.map((_, i) => (i === 0 ? "---" : "---:"))),
    ...rows.map((cells) => row(cells.map(markdownCell))),
    "",
    ...notes.map((note) => `- ${markdownText(note)}`),
    "",
  ].join("\n");
}
