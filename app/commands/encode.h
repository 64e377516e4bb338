#pragma once

#include "app/commands/common/option_groups.h"

namespace gs::app {

/// Options of `encode`.
struct EncodeCommand : ConversionOptions, ReportOptions {
  std::optional<double> tolerance;  // outline groups: max deviation in units; nullopt means a fraction of the size
  double merge = 0;                 // tolerance for merging their polygons, in units
  std::size_t groups = 0;           // approximate number of groups; 0 means as few as `tolerance` allows
  int position_bits = 16;
  bool resume = false;  // continue an interrupted run of several processes
};
int run_encode(const EncodeCommand& options);
std::optional<std::string> check_encode(const EncodeCommand& options);

class EncodeTeam;
/// Encodes one stream with the other processes of a team. All of them return the same exit status; rank 0 prints.
int encode_together(const EncodeCommand& options, EncodeTeam& team);

/// Encodes polygons as outline groups (`encode --method outlines`).
int encode_outlines(const EncodeCommand& options);

}  // namespace gs::app
