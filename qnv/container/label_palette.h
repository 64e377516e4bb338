#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Codes of the stored numbers that occur in a label volume (values/stored_code.h), ascending. An index counts them
/// from 0. Consecutive codes take no additional memory.
class LabelPalette {
 public:
  /// Maximum number of groups of consecutive codes, and of bytes of the header section.
  static constexpr std::size_t kMostGroups = std::size_t{1} << 18, kMostBytes = std::size_t{1} << 19;

  LabelPalette() = default;
  /// Takes ascending codes without repetitions.
  explicit LabelPalette(std::span<const std::uint32_t> codes);

  /// Returns the number of labels.
  [[nodiscard]] std::uint32_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  /// Returns the number of groups of consecutive codes.
  [[nodiscard]] std::size_t groups() const { return groups_.size(); }
  /// Returns the code with an index. Returns the last code for larger ones; the palette must not be empty.
  [[nodiscard]] std::uint32_t code(std::uint32_t index) const;
  /// Returns the index of a code, or nullopt if the palette does not have it.
  [[nodiscard]] std::optional<std::uint32_t> index(std::uint32_t code) const;

  friend bool operator==(const LabelPalette&, const LabelPalette&) = default;

 private:
  friend std::optional<LabelPalette> decode_label_palette(std::span<const std::byte> section);
  friend std::vector<std::byte> encode_label_palette(const LabelPalette& palette);
  struct Group {
    std::uint32_t code = 0, index = 0;  // of the first label
    friend bool operator==(const Group&, const Group&) = default;
  };
  [[nodiscard]] std::uint32_t size_of(std::size_t group) const;

  std::vector<Group> groups_;
  std::uint32_t size_ = 0;
};

/// Encodes the header section.
[[nodiscard]] std::vector<std::byte> encode_label_palette(const LabelPalette& palette);
/// Decodes the header section. Returns nullopt if it is empty, truncated or too large. Safe for untrusted bytes.
[[nodiscard]] std::optional<LabelPalette> decode_label_palette(std::span<const std::byte> section);

}  // namespace gs::qnv
