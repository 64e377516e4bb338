#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Fuzz targets: there is one program a room, which knows its targets by their names. With clang and GHOSTSPACE_FUZZ it
/// is a libFuzzer program, otherwise it replays corpora, so that these and all that was ever found run in every test
/// run. The inputs of a target lie in tests/fuzz/corpus/ROOM/NAME/.
namespace gs::fuzz {

struct FuzzTarget {
  std::string name;  // lower case, digits and '_'
  /// Takes any bytes. Ends the program where something is wrong. True when the bytes were what the target reads: at
  /// least one of its corpus must be.
  std::function<bool(std::span<const std::byte> bytes)> run;
  std::size_t most_bytes = 4096;  // of an input: longer ones are slower and reach no more
};

/// All targets of this program's room; at most one of a name.
[[nodiscard]] std::vector<FuzzTarget> fuzz_targets();

/// "VTK ImageData" is "vtk_imagedata".
[[nodiscard]] inline std::string target_name(std::string_view row) {
  std::string name;
  for (const char c : row) {
    const char lower = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    name += (lower >= 'a' && lower <= 'z') || (lower >= '0' && lower <= '9') ? lower : '_';
  }
  return name;
}

inline std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Ends the program, so that the fuzzer sees it, unless `sound`.
inline void require(bool sound) {
  if (!sound) __builtin_trap();
}

/// An input that consists of two files: what stands behind the first line of this text is the other one.
inline constexpr std::string_view kOtherFile = "\n==== the other file\n";
struct TwoFiles {
  std::span<const std::byte> first, other;
};
[[nodiscard]] inline TwoFiles two_files(std::span<const std::byte> bytes) {
  const std::size_t mark = text_of(bytes).find(kOtherFile);
  if (mark == std::string_view::npos) return {bytes, {}};
  return {bytes.first(mark), bytes.subspan(mark + kOtherFile.size())};
}

/// Pieces as long as the last byte says, so that the fuzzer can choose.
template <class Push>
void in_pieces(std::span<const std::byte> bytes, Push&& push) {
  const std::size_t piece = bytes.empty() ? 1 : 1 + std::to_integer<std::size_t>(bytes.back()) * 7;
  for (std::size_t i = 0; i < bytes.size(); i += piece) push(bytes.subspan(i, std::min(piece, bytes.size() - i)));
}

}  // namespace gs::fuzz
