#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

// Mutations of QNV streams that use the structure of the container (FORMAT.md).
namespace gs::fuzz {

using Bytes = std::vector<std::uint8_t>;

/// Maximum bytes of a mutation. Longer mutations are slower and find no more faults.
inline constexpr std::size_t kMaxMutationBytes = 24576;

/// Section of the header, or chunk: its kind and its bytes.
struct Part {
  std::uint16_t type = 0;
  Bytes bytes;
};

struct SeedStream {
  std::string name;
  std::size_t size = 0;
  Bytes fixed;  // header without its sections
  std::vector<Part> sections, chunks;
};

/// Splits a stream into parts. If the stream is invalid, follows its lengths as far as possible.
[[nodiscard]] SeedStream parts_of(const Bytes& bytes, std::string name);

/// Mutator of streams. Changes, inserts, deletes and repeats bytes of one section or payload. Repeats, moves, drops and
/// swaps chunks. Takes chunks and halves of payloads from other streams, and forges lengths. Corrects the checksums of
/// seven in eight mutations. Then damages one payload of every fourth such mutation, which parity can restore.
class Mutator {
 public:
  using ChangeBytes = std::function<void(Bytes&)>;

  /// `streams` must outlive this object. `change_bytes` makes three in four changes of bytes. If it is null, the
  /// mutator makes all changes. The seed determines the changes of the mutator.
  Mutator(const std::vector<SeedStream>& streams, std::uint64_t seed, ChangeBytes change_bytes = nullptr)
      : streams_(streams), random_(seed), other_change_(std::move(change_bytes)) {}

  /// Returns a mutation of stream number `from`.
  [[nodiscard]] Bytes mutated(std::size_t from);

 private:
  [[nodiscard]] std::size_t below(std::size_t most) { return most == 0 ? 0 : random_() % most; }
  [[nodiscard]] std::uint32_t telling_number();
  [[nodiscard]] std::size_t place(std::size_t size);
  void change_bytes(Bytes& bytes);
  [[nodiscard]] Bytes spliced(const Bytes& front, const Bytes& end);
  void change_chunks(std::vector<Part>& chunks);
  void change(SeedStream& stream);
  void forge(Bytes& bytes);
  void damage(Bytes& bytes);

  const std::vector<SeedStream>& streams_;
  std::mt19937_64 random_;
  ChangeBytes other_change_;
};

}  // namespace gs::fuzz
