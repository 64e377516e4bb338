// libFuzzer program with the targets of a room. PROGRAM --target=NAME [libFuzzer's options] CORPUS... runs a target.
// PROGRAM --list prints the name and maximum input length of each target.
#include "tests/fuzz/fuzz_target.h"

#include <cstdio>
#include <cstdlib>

namespace {

gs::fuzz::FuzzTarget& chosen() {
  static gs::fuzz::FuzzTarget target;
  return target;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  constexpr std::string_view kTarget = "--target=";
  const std::vector<gs::fuzz::FuzzTarget> targets = gs::fuzz::fuzz_targets();
  for (int i = 1; i < *count; ++i) {
    const std::string_view argument = (*arguments)[i];
    if (argument == "--list") {
      for (const gs::fuzz::FuzzTarget& target : targets)
        std::printf("%s %zu\n", target.name.c_str(), target.most_bytes);
      std::exit(0);
    }
    for (const gs::fuzz::FuzzTarget& target : targets)
      if (argument.starts_with(kTarget) && argument.substr(kTarget.size()) == target.name) chosen() = target;
  }
  if (!chosen().run) {
    std::fprintf(stderr, "expected --target=NAME with a name of --list\n");
    std::exit(2);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)chosen().run(std::as_bytes(std::span(data, size)));
  return 0;
}
