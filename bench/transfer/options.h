#pragma once

#include "bench/transfer/model.h"

#include <string>
#include <variant>
#include <vector>

namespace gs::bench {

/// Options of the transfer benchmark.
struct TransferOptions {
  std::string program;     // ghostspace
  ModelOptions model;      // its folder is empty: a temporary one
  std::string archive;     // a packed stream of some 50 MB; empty: no table for it
  std::string congestion;  // of `serve --congestion`; empty: not given to it
  std::string tcp = "cubic";
  std::vector<double> rates{1, 10, 155};         // Mbit/s
  std::vector<double> round_trips{20, 200};      // ms
  std::vector<double> losses{0, 1, 10, 30, 50};  // %
  std::vector<const Format*> formats;
  double limit = 0;  // seconds; 0: by the rate
  unsigned parallel = 8, runs = 1;
  std::uint64_t seed = 1;
  bool matrix = true, loss = true;  // tables
};

/// The text says what is wrong with the arguments.
[[nodiscard]] std::variant<TransferOptions, std::string> transfer_options(int count, char** arguments);

/// How to call it.
[[nodiscard]] const char* transfer_usage();

}  // namespace gs::bench
