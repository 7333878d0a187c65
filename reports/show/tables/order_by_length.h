// SPDX-License-Identifier: MIT
// How long must trainings be, and on how many photos, before they order methods as the paper does?
// Kendall's tau of the method order of a table, measured against published, at each number of steps
// that committed records have (agreement.h), of scenes with few photos and with many apart.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "reports/show/tables/tables.h"

namespace glint {

// A table at one number of steps.
struct OrderPoint {
  int steps = 0;
  std::string table, title, records, resolution;  // `records`: the file
  int photos = 0, most_photos = 0;  // for training, of the scenes with fewest, most; 0: not known
  int num_scenes = 0, num_seeds = 0;
  OrderAgreement mean;                        // over the columns
  std::vector<OrderAgreement> columns;        // those that every point of the table has
  std::map<std::string, std::string> titles;  // of columns, by id
  std::vector<std::string> longer;            // "GLINT 60000 steps": methods with more steps

  std::string measured_on() const;   // "5 rooms, 1 seed, 155 photos"
  std::string columns_text() const;  // "PSNR 0.60, SSIM -0.30"
  std::string series() const;        // the line in the figure that it belongs to: table, photos
};

struct OrderByLength {
  std::vector<OrderPoint> points;     // by table, then by steps
  std::vector<std::string> left_out;  // "7000 steps (FILE): lacks PGSR, Ref-GS, TSGS"
};

// Records of one file, as `read_records` has them.
struct RecordsOfFile {
  std::string file;
  int steps = 0;  // of records that do not say; 0: they are left out
  std::vector<Record> records;
  int photos = 0;  // for training, of records that do not say
};

// Of files with all methods that the paper's tables compare. A method without records of a length
// may have them of a longer one in the same file: the paper trains GLINT twice as long. Of several
// files of one length, few photos or many (kFewPhotos), the one with most rooms and seeds counts,
// of equals the first.
OrderByLength order_by_length(const std::vector<RecordsOfFile>& files);

// Of a project's folder: the files of its results (results_page.h) and of
// docs/results/lengths.json,
// [{"records": FILE, "steps": N, "photos": N}]. Errors: read_records()'s; kBadReference:
// lengths.json is damaged.
OrderByLength order_by_length(const fs::path& root);

// Where its figure lies, below the project's folder.
inline constexpr const char* kOrderFigure = "docs/results/order_by_length.svg";

// A section of docs/results/RESULTS.md: the figure, and every tau in a table.
std::string order_markdown(const OrderByLength& order);

// What the section says first.
inline constexpr const char* kOrderTitle = "Order of methods by length of training";
std::vector<std::string> order_notes(const OrderByLength& order);

}  // namespace glint
