#include "qnv/base/found_vectors.h"

#include "base/parallel.h"

#include <algorithm>

namespace gs::qnv {

void FoundVectors::append(std::span<std::vector<FoundVector>> parts, unsigned threads) {
  std::vector<std::size_t> starts(parts.size());
  std::size_t end = size_;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].resize(std::min(parts[i].size(), kMax - end));
    starts[i] = end;
    end += parts[i].size();
  }
  while (pages_.size() * kPage < end) pages_.push_back(std::make_unique_for_overwrite<FoundVector[]>(kPage));
  parallel_for(
      parts.size(),
      [&](std::size_t i) {
        std::size_t to = starts[i];
        for (std::span<const FoundVector> rest = parts[i]; !rest.empty();) {
          const std::size_t count = std::min(rest.size(), kPage - to % kPage);
          std::copy_n(rest.begin(), count, pages_[to / kPage].get() + to % kPage);
          rest = rest.subspan(count);
          to += count;
        }
        parts[i].clear();
      },
      threads);
  size_ = end;
}

// Radix sort, lowest digit first. Counts and moves each block of the list separately, so that equal keys keep their
// order for any number of threads.
std::vector<FoundVectors::Entry> FoundVectors::longest_first(unsigned threads) const {
  constexpr unsigned kPasses = 3, kMaxDigit = 11;
  constexpr std::size_t kBlocks = 16;
  std::vector<Entry> entries(size_), other(size_);
  std::array<std::uint32_t, kBlocks> longest{}, shortest{};
  const std::size_t block = size_ / kBlocks + 1;
  const auto blocks = [&](auto&& work) {
    parallel_for(
        kBlocks, [&](std::size_t b) { work(b, std::min(size_, b * block), std::min(size_, (b + 1) * block)); },
        threads);
  };
  shortest.fill(0xffffffffu);
  blocks([&](std::size_t b, std::size_t begin, std::size_t end) {
    std::uint32_t high = 0, low = 0xffffffffu;  // local copies are faster: the processors share the arrays' memory
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t key = (*this)[i].key;
      high = std::max(high, key);
      low = std::min(low, key);
      entries[i] = {key, static_cast<std::uint32_t>(i)};
    }
    longest[b] = high;
    shortest[b] = low;
  });
  const std::uint32_t most = *std::max_element(longest.begin(), longest.end());
  const std::uint32_t least = std::min(most, *std::min_element(shortest.begin(), shortest.end()));
  blocks([&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) entries[i].key = most - entries[i].key;
  });
  const auto width = static_cast<unsigned>(std::bit_width(most - least));
  const unsigned digit_bits = std::clamp((width + kPasses - 1) / kPasses, 1u, kMaxDigit);
  const std::size_t digits = std::size_t{1} << digit_bits;
  std::vector<std::size_t> starts(kBlocks * digits);
  for (unsigned shift = 0; shift < width; shift += digit_bits) {
    const auto digit = [&](const Entry& entry) { return entry.key >> shift & (digits - 1); };
    std::fill(starts.begin(), starts.end(), 0);
    blocks([&](std::size_t b, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++starts[b * digits + digit(entries[i])];
    });
    std::size_t start = 0;
    for (std::size_t d = 0; d < digits; ++d)
      for (std::size_t b = 0; b < kBlocks; ++b) {
        const std::size_t count = starts[b * digits + d];
        starts[b * digits + d] = start;
        start += count;
      }
    blocks([&](std::size_t b, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) other[starts[b * digits + digit(entries[i])]++] = entries[i];
    });
    entries.swap(other);
  }
  return entries;
}

}  // namespace gs::qnv
