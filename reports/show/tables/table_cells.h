// SPDX-License-Identifier: MIT
// One cell of a table from the records of its method and dataset.
#pragma once

#include <string>
#include <vector>

#include "reports/show/tables/common_scenes.h"
#include "reports/show/tables/tables.h"

namespace glint {

using RecordPointers = std::vector<const Record*>;

// Over scenes first, then over seeds. `common`: the scenes that the column's means are taken over.
// Fewer of them make the cell partial; none of them leaves it `apart`, the mean of what there is.
// Where there is no PSNR but that of 8-bit images, the cell holds that and is partial, too.
TableCell measured_cell(
    const RecordPointers& records, const TableColumn& column, const SizedScenes& common
);

// With the column's decimals; from ten million on by exponent, "1.234e+08", as of lost models.
std::string format_value(double value, int decimals);

// The metric of 8-bit images that stands in a column without a value of its own; empty: none.
std::string eight_bit_metric(const std::string& metric);

// What the finished records say of `column.field`, each once.
TableCell text_cell(const RecordPointers& records, const TableColumn& column);

TableCell published_cell(
    const TableDefinition& definition, const TableColumn& column, const TableRowDefinition& row
);

// "room_1/tsgs/0 failed (train: ...)", in one line.
std::string failure_note(const Record& record);

}  // namespace glint
