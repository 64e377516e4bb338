#include "qnv/container/label_palette.h"

#include "qnv/base/short_number.h"

#include <algorithm>

namespace gs::qnv {

LabelPalette::LabelPalette(std::span<const std::uint32_t> codes) {
  for (std::size_t i = 0; i < codes.size(); ++i)
    if (i == 0 || codes[i] != codes[i - 1] + 1) groups_.push_back({codes[i], static_cast<std::uint32_t>(i)});
  size_ = static_cast<std::uint32_t>(codes.size());
}

std::uint32_t LabelPalette::size_of(std::size_t group) const {
  return (group + 1 < groups_.size() ? groups_[group + 1].index : size_) - groups_[group].index;
}

std::uint32_t LabelPalette::code(std::uint32_t index) const {
  index = std::min(index, size_ - 1);
  const auto after = std::ranges::upper_bound(groups_, index, {}, &Group::index);
  const Group& group = *(after - 1);
  return group.code + (index - group.index);
}

std::optional<std::uint32_t> LabelPalette::index(std::uint32_t code) const {
  const auto after = std::ranges::upper_bound(groups_, code, {}, &Group::code);
  if (after == groups_.begin()) return std::nullopt;
  const auto group = static_cast<std::size_t>(after - groups_.begin()) - 1;
  const std::uint32_t beyond = code - groups_[group].code;
  return beyond < size_of(group) ? std::optional(groups_[group].index + beyond) : std::nullopt;
}

std::vector<std::byte> encode_label_palette(const LabelPalette& palette) {
  std::vector<std::byte> out;
  std::uint64_t next = 0;  // smallest code that may follow
  for (std::size_t i = 0; i < palette.groups_.size(); ++i) {
    const std::uint32_t first = palette.groups_[i].code, count = palette.size_of(i);
    put_number(out, first - next);
    put_number(out, count - 1);
    next = std::uint64_t{first} + count;
  }
  return out;
}

std::optional<LabelPalette> decode_label_palette(std::span<const std::byte> section) {
  constexpr std::uint64_t kCodes = std::uint64_t{1} << 32;
  if (section.size() > LabelPalette::kMostBytes) return std::nullopt;
  LabelPalette palette;
  std::uint64_t next = 0, size = 0;
  while (!section.empty()) {
    const auto skipped = take_wide_number(section), more = take_wide_number(section);
    if (!skipped || !more || palette.groups_.size() >= LabelPalette::kMostGroups) return std::nullopt;
    const std::uint64_t first = next + *skipped;
    next = first + *more + 1;
    if (next > kCodes) return std::nullopt;
    palette.groups_.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(size)});
    size += *more + 1;
    if (size >= kCodes) return std::nullopt;
  }
  palette.size_ = static_cast<std::uint32_t>(size);
  return palette.empty() ? std::nullopt : std::optional(std::move(palette));
}

}  // namespace gs::qnv
