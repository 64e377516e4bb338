#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Fuzz targets. Each room has one program with all its targets. With clang and GHOSTSPACE_FUZZ, the program uses
/// libFuzzer. Otherwise it replays corpora, so that each test run repeats all earlier findings. The inputs of a target
/// are in tests/fuzz/corpus/ROOM/NAME/.
namespace gs::fuzz {

struct FuzzTarget {
  std::string name;  // lower case, digits and '_'
  /// Processes any bytes. Ends the program if it finds a fault. Returns true if the target could read the bytes; this
  /// must be so for at least one input of its corpus.
  std::function<bool(std::span<const std::byte> bytes)> run;
  std::size_t most_bytes = 4096;  // maximum bytes of an input; longer inputs are slower and find no more faults
};

/// Returns all targets of this program's room. Their names are unique.
[[nodiscard]] std::vector<FuzzTarget> fuzz_targets();

/// Converts a table row's name to a target's name: "VTK ImageData" becomes "vtk_imagedata".
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

/// Ends the program unless `sound` is true, so that the fuzzer reports the input.
inline void require(bool sound) {
  if (!sound) __builtin_trap();
}

/// Separator in an input that consists of two files. The second file follows this text.
inline constexpr std::string_view kOtherFile = "\n==== the other file\n";
struct TwoFiles {
  std::span<const std::byte> first, other;
};
[[nodiscard]] inline TwoFiles two_files(std::span<const std::byte> bytes) {
  const std::size_t mark = text_of(bytes).find(kOtherFile);
  if (mark == std::string_view::npos) return {bytes, {}};
  return {bytes.first(mark), bytes.subspan(mark + kOtherFile.size())};
}

/// Passes the bytes in pieces. The last byte determines their length, so that the fuzzer can vary it.
template <class Push>
void in_pieces(std::span<const std::byte> bytes, Push&& push) {
  const std::size_t piece = bytes.empty() ? 1 : 1 + std::to_integer<std::size_t>(bytes.back()) * 7;
  for (std::size_t i = 0; i < bytes.size(); i += piece) push(bytes.subspan(i, std::min(piece, bytes.size() - i)));
}

}  // namespace gs::fuzz
