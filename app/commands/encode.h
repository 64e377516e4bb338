#pragma once

#include "app/commands/common/option_groups.h"

namespace gs::app {

/// Options of `encode`.
struct EncodeCommand : ConversionOptions, ReportOptions {
  bool outlines = false;
  std::optional<double> tolerance;  // of outline groups, in units; nullopt derives it from the model's size
  double merge = 0;                 // of their polygons, in units
  std::size_t groups = 0;           // approximate; 0 means as few as the tolerance allows
  int position_bits = 16;
};
int run_encode(const EncodeCommand& options);
std::optional<std::string> check_encode(const EncodeCommand& options);

/// Encodes polygons as outline groups (`encode --outlines`).
int encode_outlines(const EncodeCommand& options);

}  // namespace gs::app
