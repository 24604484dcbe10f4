// SPDX-License-Identifier: BSD-3-Clause
/// Formats a table as Markdown, LaTeX, CSV, JSON and HTML. Numbers are printed identically in all formats.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "reports/tables/report_table.h"

namespace stillpoint::report {

/// Title, table and footnotes.
[[nodiscard]] std::string table_markdown(const ReportTable& table,
                                         TableDetail detail = TableDetail::kNumbers);

/// A table environment for a document that loads booktabs, with caption and label.
[[nodiscard]] std::string table_latex(const ReportTable& table, TableDetail detail = TableDetail::kNumbers);

/// A complete document around tables, ready to compile.
[[nodiscard]] std::string latex_document(const std::string& tables);

/// One line per cell: row,source,group,column,unit,value,n,low,high,state,note.
[[nodiscard]] std::string table_csv(const ReportTable& table);

/// Every cell with its value as printed and in full precision.
[[nodiscard]] nlohmann::ordered_json table_json(const ReportTable& table);

/// A table element with caption and footnotes; measured numbers refer to their runs by data-runs.
[[nodiscard]] std::string table_html(const ReportTable& table);

}  // namespace stillpoint::report
