// SPDX-License-Identifier: BSD-3-Clause
/// One table in five formats. Numbers are the same text in all of them.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "reports/tables/report_table.h"

namespace stillpoint {

/// A title, the table, its footnotes.
[[nodiscard]] std::string table_markdown(const ReportTable& table,
                                         TableDetail detail = TableDetail::kNumbers);

/// A table environment for a document that loads booktabs, with caption and label.
[[nodiscard]] std::string table_latex(const ReportTable& table, TableDetail detail = TableDetail::kNumbers);

/// A document of its own around tables, to be compiled as it is.
[[nodiscard]] std::string latex_document(const std::string& tables);

/// One line for each cell: row,from,group,column,unit,value,n,low,high,state,note.
[[nodiscard]] std::string table_csv(const ReportTable& table);

/// Every cell with its value as printed, and in full.
[[nodiscard]] nlohmann::ordered_json table_json(const ReportTable& table);

/// A table element with caption and footnotes; each measured number refers to its runs by data-runs.
[[nodiscard]] std::string table_html(const ReportTable& table);

}  // namespace stillpoint
