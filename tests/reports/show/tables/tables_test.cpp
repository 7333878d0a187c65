// SPDX-License-Identifier: MIT
// tests/reports/golden: a fixed records.jsonl and the tables that it must give.
#include "reports/show/tables/tables.h"
#include "reports/run/records/lossy_renders.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>

#include "glint/core/rows.h"
#include "glint/method.h"
#include "metrics/metric.h"
#include "reports/show/tables/published.h"
#include "reports/show/tables/table_writers.h"
#include "tests/support/table_parts.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

const fs::path kGolden = "tests/reports/golden";

Table golden_table(const std::string& id) {
  return build_table(definition_of(id), read_records(kGolden / "records.jsonl"));
}

// A line for each value that holds no other with names or places: where it stands, and itself.
std::string lines_of(const Json& json, const std::string& place = "") {
  const bool holds_others =
      std::any_of(json.begin(), json.end(), [](const Json& part) { return part.is_structured(); });
  if (!holds_others) return place + " " + json.dump() + "\n";
  std::string lines;
  for (const auto& part : json.items()) lines += lines_of(part.value(), place + "/" + part.key());
  return lines;
}

}  // namespace

TEST_CASE("a cell is the mean over scenes, then over seeds") {
  const Table table = golden_table("table1_photometric");
  const TableCell& cell = cell_of(table, "2dgs", "psnr");
  CHECK(cell.value == ((30.0 + 32.5) / 2 + (31.0 + 33.0) / 2) / 2);
  CHECK(cell.num_scenes == 2);
  CHECK(cell.num_seeds == 2);
  CHECK(cell.spread == 32.0 - 31.25);  // two seeds: their range
}

TEST_CASE("three seeds have a sample standard deviation") {
  std::vector<Record> records;
  for (const double psnr : {30.0, 31.0, 33.0})
    records.push_back(record_of("2dgs", psnr, records.size()));
  const Table table = build_table(definition_of("table1_photometric"), records);
  CHECK(cell_of(table, "2dgs", "psnr").spread == Approx(std::sqrt(7.0 / 3)).epsilon(1e-14));
}

TEST_CASE("what methods have to say of their runs stands once below tables with their row") {
  std::vector<Record> records;
  for (const std::uint64_t seed : {0, 1}) {
    records.push_back(record_of("2dgs", 30, seed));
    records.back().notes = {"seen without masks"};
  }
  const Table table = build_table(definition_of("table1_photometric"), records);
  CHECK(std::count(table.notes.begin(), table.notes.end(), "2DGS: seen without masks.") == 1);
}

TEST_CASE("rows that were trained for different numbers of steps are told") {
  std::vector<Record> records;
  for (const char* method : {"2dgs", "pgsr", "glint"}) {
    records.push_back(record_of(method, 30));
    records.back().iterations = 3000;
  }
  const auto notes = [&] {
    const Table table = build_table(definition_of("table1_photometric"), records);
    return fmt::format("{}", fmt::join(table.notes, " "));
  };
  CHECK_THAT(notes(), !Catch::Contains("numbers of steps"));
  records[1].iterations = 0;  // unknown
  CHECK_THAT(notes(), !Catch::Contains("numbers of steps"));
  records[2].iterations = 6000;
  CHECK_THAT(
      notes(), Catch::Contains("Trained for different numbers of steps (3000: 2DGS; 6000: GLINT).")
  );
}

TEST_CASE("tables say on how many photos scenes were trained, and whether those are few") {
  std::vector<Record> records{record_of("2dgs", 30), record_of("glint", 31)};
  const auto notes = [&] {
    const Table table = build_table(definition_of("table1_photometric"), records);
    return fmt::format("{}", fmt::join(table.notes, " "));
  };
  CHECK_THAT(notes(), !Catch::Contains("Photos for training"));  // records of older versions
  records[0].training_views = 155;
  CHECK_THAT(notes(), Catch::Contains("Photos for training, a scene: 155."));
  records[1].training_views = 42;
  CHECK_THAT(
      notes(),
      Catch::Contains("Photos for training, a scene: 42 to 155 (a scene of 3D-FRONT-T: 156); with "
                      "so few, the order by pictures can be another.")
  );
  records[1].failure.emplace();
  CHECK_THAT(notes(), Catch::Contains("a scene: 155."));
}

TEST_CASE("methods that were not run are missing, in every format a word") {
  const Table table = golden_table("table1_photometric");
  CHECK(cell_of(table, "pgsr", "psnr").status == CellStatus::kMissing);
  CHECK(cell_of(table, "2dgs", "lpips-vgg-3dgs").status == CellStatus::kMissing);
  CHECK(
      table_csv(table).find("\npgsr,missing,missing,missing,missing,31.96,0.95,0.07") !=
      std::string::npos
  );
  CHECK(table_markdown(table).find("| PGSR | missing |") != std::string::npos);
  CHECK(table_json(table)["rows"][1]["cells"]["psnr"]["status"] == "missing");
  CHECK_FALSE(table_json(table)["rows"][1]["cells"]["psnr"].contains("value"));
}

TEST_CASE("a metric that the machine had no weights for says so in every format") {
  Record record = record_of("2dgs", 30);
  record.not_measured["lpips-vgg-3dgs"] = "no weights";
  const Table table = build_table(definition_of("table1_photometric"), {record});
  CHECK(cell_of(table, "2dgs", "lpips-vgg-3dgs").status == CellStatus::kUnavailable);
  CHECK(cell_of(table, "2dgs", "lpips-vgg-3dgs").rank == 0);
  CHECK(cell_of(table, "2dgs", "ssim-3dgs").status == CellStatus::kMissing);
  CHECK(table_csv(table).find("\n2dgs,30,missing,no weights,missing,") != std::string::npos);
  CHECK(table_markdown(table).find("scripts/fetch_lpips_weights.sh") != std::string::npos);
  for (const std::string& text : {table_markdown(table), table_latex(table), table_terminal(table)})
    CHECK(text.find("no weights") != std::string::npos);
  const Json cell = table_json(table)["rows"][0]["cells"]["lpips-vgg-3dgs"];
  CHECK(cell["status"] == "unavailable");
  CHECK(cell["note"] == "no weights");
  CHECK_FALSE(cell.contains("value"));
}

TEST_CASE("what neither a method nor the data allow is not applicable, not missing") {
  Record record = record_of("2dgs", 30);
  record.metrics["psnr@opaque"] = 31;
  record.not_applicable = {"transparency-iou"};
  const Table decomposition = build_table(definition_of("decomposition"), {record});
  const TableCell& cell = cell_of(decomposition, "2dgs", "transparency-iou");
  CHECK(cell.status == CellStatus::kNotApplicable);
  CHECK_FALSE(cell.note.empty());
  CHECK(cell_of(decomposition, "2dgs", "behind-absrel").status == CellStatus::kMissing);
  const Table regions = build_table(definition_of("regions"), {record});
  CHECK(cell_of(regions, "2dgs", "psnr@opaque").status == CellStatus::kOk);
  CHECK(cell_of(regions, "2dgs", "psnr@glass").status == CellStatus::kNotApplicable);
  CHECK(cell_of(regions, "envgs", "psnr@glass").status == CellStatus::kMissing);
}

TEST_CASE("a method that failed everywhere says why") {
  const TableCell cell = cell_of(golden_table("table1_photometric"), "tsgs", "psnr");
  CHECK(cell.status == CellStatus::kFailed);
  CHECK(cell.note == "room_1/tsgs/0 failed (dataset: no points)");
}

TEST_CASE("a mean over fewer scenes is marked and takes no rank, even when it looks best") {
  const Table table = golden_table("table1_photometric");
  const TableCell& partial = cell_of(table, "glint", "psnr");
  CHECK(partial.status == CellStatus::kPartial);
  CHECK(partial.num_scenes == 1);
  CHECK(partial.rank == 0);
  CHECK(shown_text(partial, table.columns[0]) == "34.00*");
  CHECK(cell_of(table, "envgs", "psnr").rank == 1);
  CHECK(cell_of(table, "2dgs", "psnr").rank == 2);
}

TEST_CASE("an import of another scene or size stands apart, and the others keep their ranks") {
  auto records = read_records(kGolden / "records.jsonl");
  Record import = records[1];
  import.cell.method = "mine";
  import.imported = "renders";
  import.metrics["psnr"] = 99;
  const auto table_with = [&](const std::string& scene, const std::string& resolution) {
    import.cell.scene = scene;
    import.resolution = resolution;
    records.push_back(import);
    const Table table = build_table(definition_of("table1_photometric"), records);
    records.pop_back();
    return table;
  };
  for (const auto& [scene, size] : {std::pair("room_1", "120x68"), std::pair("room_9", "160x90")}) {
    const Table table = table_with(scene, size);
    CHECK(cell_of(table, "envgs", "psnr").rank == 1);
    CHECK(cell_of(table, "2dgs", "psnr").rank == 2);
    CHECK(cell_of(table, "mine", "psnr").rank == 0);
    CHECK(table.rows.back().method == "mine");
    CHECK(shown_text(table.rows.back().cells[0], table.columns[0]) == "99.00*");
    const std::string note = fmt::format("mean over {} at {} only", scene, size);
    CHECK(table_markdown(table).find(note) != std::string::npos);
    CHECK(table.notes[0].find("room_1 at 160x90, room_2 at 160x90") != std::string::npos);
    CHECK(table.rows.back().title.ends_with("(renders imported)"));
  }
  import.warnings = {fmt::format("8 of 8 pictures are {}: scores", kLossyRenders)};
  CHECK(table_with("room_1", "160x90").rows.back().title.ends_with("(renders imported as JPEG)"));
  // The same scene at the same size: a mean over fewer scenes.
  const Table table = table_with("room_1", "160x90");
  CHECK(cell_of(table, "mine", "psnr").note == "mean over 1 of 2 scenes");
  CHECK(cell_of(table, "envgs", "psnr").rank == 1);
}

TEST_CASE("scenes that only one method has do not move its mean") {
  auto records = read_records(kGolden / "records.jsonl");
  Record third = records[5];
  REQUIRE(third.cell.method == "envgs");
  third.cell.scene = "room_3";
  third.metrics["psnr"] = 10;
  records.push_back(third);
  const Table table = build_table(definition_of("table1_photometric"), records);
  CHECK(cell_of(table, "envgs", "psnr").value == 34);
  CHECK(cell_of(table, "envgs", "psnr").rank == 1);
  CHECK(table.notes[1] == "Not in these means, as too few methods have them: room_3 at 160x90.");
}

TEST_CASE("the PSNR of 8-bit images is shown, named and not ranked") {
  auto records = read_records(kGolden / "records.jsonl");
  for (const char* scene : {"room_1", "room_2"}) {
    Record record = records[1];
    record.cell = {scene, "mine", 0};
    record.metrics = {{"psnr-8bit", 99}, {"ssim-3dgs", 0.99}};
    records.push_back(record);
  }
  const Table table = build_table(definition_of("table1_photometric"), records);
  CHECK(cell_of(table, "mine", "psnr").text == "99.00");
  CHECK(cell_of(table, "mine", "psnr").rank == 0);
  CHECK(cell_of(table, "mine", "psnr").note == "of 8-bit images (psnr-8bit)");
  CHECK(cell_of(table, "mine", "ssim-3dgs").rank == 1);
  CHECK(cell_of(table, "envgs", "psnr").rank == 1);
}

TEST_CASE("ranks go by unrounded values, ties share one, and lower is better where it is") {
  const TableDefinition definition = definition_of("table2_geometry");
  std::vector<Record> records;
  const std::pair<const char*, double> values[] = {
      {"2dgs", 10.004}, {"pgsr", 10.001}, {"envgs", 10.001}, {"tsgs", 10.009}, {"glint", 12}};
  for (const auto& [method, value] : values)
    records.push_back(record_of({"room_1", method, 0}, {{"normal-mae", value}}));
  const Table table = build_table(definition, records);
  CHECK(cell_of(table, "pgsr", "normal-mae").rank == 1);
  CHECK(cell_of(table, "envgs", "normal-mae").rank == 1);
  CHECK(cell_of(table, "2dgs", "normal-mae").rank == 3);
  CHECK(cell_of(table, "tsgs", "normal-mae").rank == 0);
}

TEST_CASE("a single measured method is not best of anything") {
  const Table table = build_table(definition_of("table1_photometric"), {record_of("2dgs", 30)});
  CHECK(cell_of(table, "2dgs", "psnr").rank == 0);
}

TEST_CASE("published columns hold the paper's digits and are marked in every format") {
  const Table table = golden_table("table1_photometric");
  CHECK(cell_of(table, "glint", "published/3D-FRONT-T/PSNR").text == "34.50");
  CHECK(table_markdown(table).find("3D-FRONT-T†") != std::string::npos);
  CHECK(table_latex(table).find("3D-FRONT-T$^\\dagger$ (published)") != std::string::npos);
  CHECK(table_terminal(table).find("3D-FRONT-T†") != std::string::npos);
  CHECK(table_csv(table).find("published/3D-FRONT-T/PSNR") != std::string::npos);
}

TEST_CASE(
    "ranks shade with the paper's three blues on a colour terminal and in LaTeX, there with bold "
    "and "
    "underlined, too"
) {
  const Table table = golden_table("table1_photometric");
  CHECK(
      table_latex(table).find("\\cellcolor[RGB]{200,225,255}\\textbf{34.00} & ") !=
      std::string::npos
  );
  CHECK(
      table_latex(table).find("\\cellcolor[RGB]{225,240,255}\\underline{31.62 $\\pm$ 0.75}") !=
      std::string::npos
  );
  CHECK(table_terminal(table, {true, 0}).find("48;2;200;225;255m") != std::string::npos);
  CHECK(table_terminal(table).find('\x1b') == std::string::npos);
}

TEST_CASE("the order of methods is compared with the paper's, column by column") {
  const Table table = golden_table("table1_photometric");
  REQUIRE_FALSE(table.agreement.empty());
  CHECK(table.agreement[0].column == "psnr");
  CHECK(table.agreement[0].num_methods == 2);  // 2dgs and envgs; glint is incomplete
  CHECK(table.agreement[0].tau == 1);
}

TEST_CASE("the paper's missing cells are not applicable, its hours are as printed") {
  const Table table = golden_table("tableB_cost");
  CHECK(cell_of(table, "2dgs", "published/3D-FRONT-T/FPS").status == CellStatus::kNotApplicable);
  CHECK(cell_of(table, "glint", "published/3D-FRONT-T/Training Time").text == "~2.5 h");
  CHECK(cell_of(table, "2dgs", "device").text == "cpu");
  CHECK(cell_of(table, "2dgs", "resolution").text == "160x90");
  CHECK(table_json(table)["rows"][0]["cells"]["device"]["text"] == "cpu");
}

TEST_CASE("records of a further dataset get columns of their own where they have values") {
  auto records = read_records(kGolden / "records.jsonl");
  Record fox = records[1];
  fox.dataset = "nerfstudio";
  fox.cell.scene = "fox";
  fox.metrics = {{"psnr", 21}};
  records.push_back(fox);
  const Table table = build_table(definition_of("table1_photometric"), records);
  CHECK(cell_of(table, "2dgs", "nerfstudio/psnr").value == 21);
  CHECK(cell_of(table, "2dgs", "psnr").num_scenes == 2);
  CHECK(table.columns.size() == golden_table("table1_photometric").columns.size() + 1);
  CHECK(
      build_table(definition_of("table2_geometry"), records).columns.size() ==
      golden_table("table2_geometry").columns.size()
  );
}

TEST_CASE("methods of other tables have no say in the scenes that a table compares") {
  const Record any = read_records(kGolden / "records.jsonl").front();
  std::vector<Record> records;
  const auto add = [&](const char* method, const std::vector<const char*>& rooms) {
    for (const char* room : rooms) {
      records.push_back(any);
      records.back().cell = {room, method, 0};
      records.back().metrics = {{"psnr", room == std::string("a") ? 20 : 30}};
    }
  };
  for (const char* method : {"2dgs", "pgsr", "envgs", "tsgs", "glint"})
    add(method, {"a", "b", "c"});
  for (const char* method : {"glint/no-trans", "glint/no-refl", "glint/no-lgeo"})
    add(method, {"a"});
  const Table ablation = build_table(definition_of("table3_ablation"), records);
  CHECK(cell_of(ablation, "glint", "psnr").value == 20);
  CHECK(cell_of(ablation, "glint/no-refl", "psnr").status == CellStatus::kOk);
  const Table all = build_table(definition_of("table1_photometric"), records);
  CHECK(cell_of(all, "glint", "psnr").value == Approx(80.0 / 3));
}

TEST_CASE("seeds that have fewer scenes than others are in no mean") {
  const Record any = read_records(kGolden / "records.jsonl").front();
  std::vector<Record> records;
  const auto add = [&](const char* method, const char* room, std::uint64_t seed, double psnr) {
    records.push_back(any);
    records.back().cell = {room, method, seed};
    records.back().metrics = {{"psnr", psnr}};
  };
  for (const char* method : {"2dgs", "glint"}) {
    add(method, "a", 0, 20);
    add(method, "b", 0, 30);
    add(method, "a", 1, 22);
  }
  add("glint", "b", 1, 32);
  const Table table = build_table(definition_of("table1_photometric"), records);
  CHECK(cell_of(table, "2dgs", "psnr").value == 25);
  CHECK(cell_of(table, "2dgs", "psnr").num_seeds == 1);
  CHECK(cell_of(table, "2dgs", "psnr").status == CellStatus::kOk);
  CHECK(cell_of(table, "glint", "psnr").value == 26);
  CHECK_THAT(table_markdown(table), Catch::Contains("- 2DGS: 1 of 2 seeds."));
}

TEST_CASE("every method with records has a row under its title in every table") {
  auto records = read_records(kGolden / "records.jsonl");
  Record mine = records[1];
  mine.cell.method = "mine";
  records.push_back(mine);
  for (const TableDefinition& definition : table_definitions()) {
    INFO(definition.id);
    const Table table = build_table(definition, records);
    const auto row = std::find_if(table.rows.begin(), table.rows.end(), [](const TableRow& r) {
      return r.method == "mine";
    });
    CHECK(row != table.rows.end());
  }
  records.back().cell.method = "2dgs/prior";
  for (const TableDefinition& definition : table_definitions())
    for (const TableRow& row : build_table(definition, records).rows)
      if (row.method == "2dgs/prior") CHECK(row.title == "2DGS + priors");
}

TEST_CASE("what a table leaves out stands in another one, or is a method of this program") {
  std::set<std::string> known;
  for (const TableDefinition& definition : table_definitions())
    for (const TableRowDefinition& row : definition.rows) known.insert(row.method);
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) known.insert(id);
  for (const TableDefinition& definition : table_definitions())
    for (const std::string& glob : definition.leave_out) {
      INFO(definition.id << " " << glob);
      CHECK(std::ranges::any_of(known, [&](const std::string& method) {
        return glob_match(glob, method);
      }));
    }
}

TEST_CASE("without any record every measured cell is missing and the paper's stand") {
  for (const TableDefinition& definition : table_definitions()) {
    const Table table = build_table(definition, {});
    for (const TableRow& row : table.rows)
      for (std::size_t i = 0; i < row.cells.size(); ++i)
        if (!table.columns[i].published) CHECK(row.cells[i].status == CellStatus::kMissing);
  }
}

TEST_CASE("columns agree with the metric registry on unit and which way is better") {
  for (const TableDefinition& definition : table_definitions())
    for (const TableColumn& column : definition.columns) {
      const Metric* metric = find_metric(column.metric);
      INFO(definition.id << " " << column.metric << column.field);
      if (!metric) {  // of cost, or what a run says of itself
        static const std::set<std::string> others{
            "", "train-minutes", "peak-memory", "device-memory", "fps", "num-surfels"};
        CHECK(others.contains(column.metric));
        continue;
      }
      if (column.scale == 10 && column.unit == "dm")
        CHECK(metric->unit == "m");
      else
        CHECK((metric->unit == column.unit && column.scale == 1));
      CHECK(
          (metric->direction == Direction::kHigherIsBetter) ==
          (column.order == RankOrder::kHigherFirst)
      );
    }
}

TEST_CASE("the tables of fixed records equal the golden files") {
  for (const std::string id : {"table1_photometric", "table2_geometry", "tableB_cost"}) {
    const Table table = golden_table(id);
    CHECK(table_markdown(table) == read_file(kGolden / (id + ".md")));
    CHECK(table_latex(table) == read_file(kGolden / (id + ".tex")));
    CHECK(table_csv(table) == read_file(kGolden / (id + ".csv")));
    CHECK(table_terminal(table) == read_file(kGolden / (id + ".txt")));
  }
  const Json json = table_json(golden_table("table1_photometric"));
  CHECK(lines_of(json) == read_file(kGolden / "table1_photometric.values"));
}

TEST_CASE("a second place that the paired bootstrap cannot tell from the first is tied") {
  std::vector<Record> records;
  const auto add = [&](const char* method, const std::vector<double>& values) {
    for (std::size_t seed = 0; seed < values.size(); ++seed)
      records.push_back(record_of(method, values[seed], seed));
  };
  add("2dgs", {30.0, 31.0, 32.0});
  add("envgs", {29.9, 31.2, 31.8});
  const auto table = [&] { return build_table(definition_of("table1_photometric"), records); };
  CHECK(cell_of(table(), "envgs", "psnr").rank == 2);
  CHECK(cell_of(table(), "envgs", "psnr").tied);
  CHECK_FALSE(cell_of(table(), "2dgs", "psnr").tied);
  CHECK(table_markdown(table()).find("_30.97 ± 0.97≈_") != std::string::npos);
  CHECK(table_markdown(table()).find("- ≈ tied with the first") != std::string::npos);
  CHECK(table_json(table())["rows"][3]["cells"]["psnr"]["tied_with_first"] == true);
  records.resize(3);
  add("envgs", {29.9, 30.9, 31.7});  // worse on every seed
  CHECK_FALSE(cell_of(table(), "envgs", "psnr").tied);
  CHECK(table_markdown(table()).find("≈") == std::string::npos);
}

TEST_CASE("fewer than three pairs of scene and seed claim no tie and say so") {
  const Table table = build_table(
      definition_of("table1_photometric"), {record_of("2dgs", 30), record_of("envgs", 29.99)}
  );
  CHECK_FALSE(cell_of(table, "envgs", "psnr").tied);
  CHECK(table_markdown(table).find("- Fewer than 3 pairs") != std::string::npos);
}

TEST_CASE("a terminal's table is no wider than the terminal") {
  const Table table = golden_table("table1_photometric");
  CHECK(table_terminal(table, {false, 1000}) == table_terminal(table));
  for (const std::size_t width : {140, 100, 60, 40}) {
    INFO(width);
    const std::string text = table_terminal(table, {false, width});
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) CHECK(text_width(line) <= width);
    CHECK(text.find("3D-FRONT-T†") != std::string::npos);
    CHECK(text.find("31.62 ± 0.75") != std::string::npos);
  }
}

TEST_CASE("a brief table has measured columns with values and the notes on means and marks") {
  const std::string text = table_terminal(golden_table("table1_photometric"), {false, 0, true});
  for (const char* absent : {"†", "LPIPS", "Kendall", "failed (", "missing (", "Fewer than"})
    CHECK(text.find(absent) == std::string::npos);
  for (const char* there : {"31.62 ± 0.75", "Mean over test views", "* GLINT: mean over 1 of 2"})
    CHECK(text.find(there) != std::string::npos);
}

TEST_CASE("a brief table without any value says which methods failed, not that they were not run") {
  auto records = read_records(kGolden / "records.jsonl");
  std::erase_if(records, [](const Record& record) { return record.ok(); });
  std::erase_if(records, [](const Record& record) { return record.cell.method != "tsgs"; });
  REQUIRE_FALSE(records.empty());
  const Table table = build_table(definition_of("table1_photometric"), records);
  const std::string text = table_terminal(table, {false, 0, true});
  CHECK(text.find("Failed: TSGS.") != std::string::npos);
  CHECK(text.find("Not run: 2DGS") != std::string::npos);
  CHECK(text.find("Ref-GS, EnvGS, GLINT") != std::string::npos);
}

TEST_CASE("LaTeX gets no character that it cannot print") {
  Table table = golden_table("table1_photometric");
  table.rows[0].title = "a\\b_{c}^2 ≈ 漢\t|";
  const std::string tex = table_latex(table);
  CHECK(
      tex.find("a\\textbackslash{}b\\_\\{c\\}\\textasciicircum{}2 $^\\approx$ ??$|$") !=
      std::string::npos
  );
}

TEST_CASE("LaTeX gets a minus for signs and differences, hyphens stay") {
  Table table = golden_table("table1_photometric");
  table.rows[0].title = "-1.5, a - b, x-y 3D-F -z";
  CHECK(table_latex(table).find("$-$1.5, a $-$ b, x-y 3D-F -z &") != std::string::npos);
}

TEST_CASE("pdflatex compiles all tables in one document") {
  if (std::system("command -v pdflatex >/dev/null 2>&1") != 0) {
    WARN("skipped: no pdflatex; scripts/setup_extras.sh installs it");
    return;
  }
  const test::TempFolder folder;
  std::vector<Table> tables;
  for (const TableDefinition& definition : table_definitions()) {
    tables.push_back(build_table(definition, read_records(kGolden / "records.jsonl")));
    tables.back().notes.push_back("100% of $a_b$ #1 & ~^\\ {x} 漢");
    write_table(folder.path(), tables.back());
  }
  write_file(folder / "all.tex", latex_document(tables));
  const std::string command = fmt::format(
      "cd '{}' && pdflatex -interaction=nonstopmode -halt-on-error all.tex >out.txt 2>&1",
      folder.path().string()
  );
  const bool compiled = std::system(command.c_str()) == 0;
  INFO((compiled ? "" : read_file(folder / "out.txt")));
  CHECK(compiled);
  CHECK(fs::exists(folder / "all.pdf"));
}

TEST_CASE("a definition with an unknown key or direction is an error naming the file") {
  CHECK_THROWS_WITH(
      parse_table_definition("titel = 'x'", "t"), Catch::Contains("tables/t.toml: no field 'titel'")
  );
  CHECK_THROWS_WITH(
      parse_table_definition("columns = [{metric = 'm', direction = 'up'}]", "t"),
      Catch::Contains("direction is 'up'")
  );
  CHECK_THROWS_WITH(parse_table_definition("a = [", "t"), Catch::Contains("tables/t.toml:1"));
}
