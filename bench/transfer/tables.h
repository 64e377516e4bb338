#pragma once

#include "bench/transfer/model.h"
#include "bench/transfer/options.h"
#include "bench/transfer/run.h"

#include <map>

namespace gs::bench {

using AllThresholds = std::map<const Format*, Thresholds>;

/// Prints the measured objects and the settings.
void print_settings(const TransferOptions& options, const Model& model);
/// Prints a row per format: bytes, and the part that a picture needs. Formats without a file are omitted in all tables.
[[nodiscard]] AllThresholds print_sizes(const TransferOptions& options, Model& model);
/// Measures all formats on all links. Prints a table per rate and round trip, with formats as rows and losses as
/// columns. Returns false if a measurement failed.
[[nodiscard]] bool print_matrix(const TransferOptions& options, Model& model, const ServerSpec& server,
                                const AllThresholds& thresholds);
/// Prints the effect of losses on the final picture over cells, at 10 Mbit/s and 20 ms.
[[nodiscard]] bool print_loss(const TransferOptions& options, Model& model, const ServerSpec& server);
/// Prints the time of the first picture of a large archive at 10 Mbit/s and 100 ms.
[[nodiscard]] bool print_archive(const TransferOptions& options, Studio& studio, const ServerSpec& server);

}  // namespace gs::bench
