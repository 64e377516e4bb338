#include "tests/simulation/cell_session.h"
#include "tests/simulation/http_session.h"
#include "tests/simulation/trace.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>

// Runs sessions over simulated networks, each twice, from seeds.
//
//   simulate FIRST COUNT     runs COUNT seeds from FIRST on
//   simulate --print SEED    runs one seed and prints what happens

namespace {

using namespace gs::simulation;

SessionResult run(std::uint64_t seed, bool prints) {
  return seed % 2 == 0 ? run_http_session(seed, prints) : run_cell_session(seed, prints);
}

}  // namespace

int main(int count, char** arguments) {
  const bool prints = count == 3 && std::strcmp(arguments[1], "--print") == 0;
  if (count != 3) {
    std::fprintf(stderr, "usage: simulate FIRST COUNT | simulate --print SEED\n");
    return 2;
  }
  const std::uint64_t first = std::strtoull(arguments[prints ? 2 : 1], nullptr, 10);
  const std::uint64_t seeds = prints ? 1 : std::strtoull(arguments[2], nullptr, 10);
  std::uint64_t failures = 0;
  std::map<std::string, std::uint64_t> sums;
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) try {
      const SessionResult result = run(seed, prints);
      require(run(seed, false).hash == result.hash, "a second run differs");
      for (const auto& [name, number] : result.counts) sums[name] += number;
    } catch (const Violation& violation) {
      ++failures;
      std::printf("seed %llu: error: %s; see simulate --print %llu\n", static_cast<unsigned long long>(seed),
                  violation.what(), static_cast<unsigned long long>(seed));
    }
  if (seeds == 0) return 2;
  for (const auto& [name, number] : sums)
    std::printf("%14llu %s\n", static_cast<unsigned long long>(number), name.c_str());
  std::printf("%llu sessions, each run twice: %llu violations\n", static_cast<unsigned long long>(seeds),
              static_cast<unsigned long long>(failures));
  return failures == 0 ? 0 : 1;
}
