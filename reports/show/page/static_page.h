// SPDX-License-Identifier: MIT
// Pages without a program: tables as the report page shows them, in one file that opens from
// file:// and asks for nothing.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "reports/show/tables/tables.h"

namespace glint {

// A whole page: `body` is HTML, `title` is text.
std::string static_page(const std::string& title, const std::string& body);

// What a pointer on a cell is told beside its rank, interval and note; empty: nothing.
using CellHint = std::function<std::string(const TableRow& row, std::size_t column)>;

// A card with title, caption, table and notes; columns in which no row has a value are named below
// it. Names may hold anything.
std::string table_html(const Table& table, const CellHint& hint = {});

// A plain table: the head, and rows of text, of which numbers stand flush right.
std::string plain_table_html(
    const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows
);

std::string list_html(const std::vector<std::string>& items);  // of HTML

// Markdown of one line, of which `code` and [links](to) are known.
std::string inline_markdown_html(std::string_view markdown);

// Text for an element: printable, and no letter of it begins a tag.
std::string page_text(std::string_view text);

}  // namespace glint
