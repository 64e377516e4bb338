#pragma once

#include "bench/transfer/model.h"
#include "bench/transfer/options.h"
#include "bench/transfer/run.h"

#include <map>

namespace gs::bench {

using AllThresholds = std::map<const Format*, Thresholds>;

/// Prints the measured objects and the settings.
void print_settings(const TransferOptions& options, const Model& model);
/// A row a format: bytes, and how many of them a picture takes. Formats without a file are left out here and below.
[[nodiscard]] AllThresholds print_sizes(const TransferOptions& options, Model& model);
/// Measures all formats on all links. A table a rate and round trip: rows formats, columns losses. False when something
/// could not be measured.
[[nodiscard]] bool print_matrix(const TransferOptions& options, Model& model, const ServerSpec& server,
                                const AllThresholds& thresholds);
/// Prints the effect of losses on the final picture over cells, at 10 Mbit/s and 20 ms.
[[nodiscard]] bool print_loss(const TransferOptions& options, Model& model, const ServerSpec& server);
/// The first picture of a large archive at 10 Mbit/s and 100 ms.
[[nodiscard]] bool print_archive(const TransferOptions& options, Studio& studio, const ServerSpec& server);

}  // namespace gs::bench
