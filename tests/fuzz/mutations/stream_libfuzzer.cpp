// Mutator of libFuzzer for QNV streams. Half of its mutations use the structure of the container, so that changed
// payloads reach the decoders with correct lengths and checksums.
#include "tests/fuzz/mutations/stream_mutator.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned int seed) {
  using namespace gs::fuzz;
  if (seed % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  const std::vector<SeedStream> streams{parts_of(Bytes(data, data + size), {})};
  if (streams.front().chunks.empty()) return LLVMFuzzerMutate(data, size, most);
  const auto change = [&](Bytes& bytes) {
    const std::size_t before = bytes.size();
    bytes.resize(before + 16);
    bytes.resize(LLVMFuzzerMutate(bytes.data(), before, bytes.size()));
  };
  const Bytes made = Mutator(streams, seed, change).mutated(0);
  const std::size_t count = std::min(made.size(), most);
  std::copy_n(made.begin(), count, data);
  return count;
}
