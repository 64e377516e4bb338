#pragma once

#include "bench/transfer/model.h"

#include <string>
#include <variant>
#include <vector>

namespace gs::bench {

/// Options of the transfer benchmark.
struct TransferOptions {
  std::string program;     // path of ghostspace
  ModelOptions model;      // if `folder` is empty, a temporary folder is used
  std::string archive;     // path of an octree stream of about 50 MB; if empty, its table is omitted
  std::string congestion;  // for `serve --congestion`, unless empty
  std::string tcp = "cubic";
  std::vector<double> rates{1, 10, 155};         // Mbit/s
  std::vector<double> round_trips{20, 200};      // ms
  std::vector<double> losses{0, 1, 10, 30, 50};  // %
  std::vector<const Format*> formats;
  double limit = 0;  // seconds; 0 derives it from the rate
  unsigned parallel = 8, runs = 1;
  std::uint64_t seed = 1;
  bool matrix = true, loss = true;  // tables
};

/// Parses the arguments. Returns a message on failure.
[[nodiscard]] std::variant<TransferOptions, std::string> transfer_options(int count, char** arguments);

/// Returns the usage text.
[[nodiscard]] const char* transfer_usage();

}  // namespace gs::bench
