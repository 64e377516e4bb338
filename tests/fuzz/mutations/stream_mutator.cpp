#include "tests/fuzz/mutations/stream_mutator.h"

#include "tests/fuzz/stream_bytes.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gs::fuzz {
namespace {

Bytes joined(const SeedStream& stream) {
  Bytes bytes = stream.fixed;
  const auto put = [&](std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  };
  for (const Part& section : stream.sections) {
    put(section.type, 2);
    put(static_cast<std::uint32_t>(section.bytes.size()), 4);
    bytes.insert(bytes.end(), section.bytes.begin(), section.bytes.end());
  }
  put_number(bytes, kHeaderLength, static_cast<std::uint32_t>(bytes.size()), 4);
  for (const Part& chunk : stream.chunks) {
    put(0x4351, 2);
    put(static_cast<std::uint32_t>(chunk.bytes.size()), 2);
    put(chunk.type, 1);
    put(0, 5);
    bytes.insert(bytes.end(), chunk.bytes.begin(), chunk.bytes.end());
  }
  return bytes;
}

}  // namespace

SeedStream parts_of(const Bytes& bytes, std::string name) {
  SeedStream stream;
  stream.name = std::move(name);
  stream.size = bytes.size();
  if (bytes.size() < kFixedHeader) return stream;
  const auto at = [&](std::size_t from, std::size_t count) {
    const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(from);
    return Bytes(first, first + static_cast<std::ptrdiff_t>(count));
  };
  stream.fixed = at(0, kFixedHeader);
  const std::size_t header = std::min<std::size_t>(number_at(bytes, kHeaderLength, 4), bytes.size());
  for (std::size_t i = kFixedHeader; i + kSectionHead <= header;) {
    const std::size_t size = std::min<std::size_t>(number_at(bytes, i + 2, 4), header - i - kSectionHead);
    stream.sections.push_back({static_cast<std::uint16_t>(number_at(bytes, i, 2)), at(i + kSectionHead, size)});
    i += kSectionHead + size;
  }
  for (std::size_t i = std::max(header, kFixedHeader); i + kChunkHead <= bytes.size();) {
    const std::size_t size = std::min<std::size_t>(number_at(bytes, i + 2, 2), bytes.size() - i - kChunkHead);
    stream.chunks.push_back({bytes[i + 4], at(i + kChunkHead, size)});
    i += kChunkHead + size;
  }
  return stream;
}

Bytes Mutator::mutated(std::size_t from) {
  SeedStream stream = streams_[from];
  const std::size_t times = 1 + below(4);
  for (std::size_t i = 0; i < times; ++i) change(stream);
  Bytes bytes = joined(stream);
  if (below(6) == 0) forge(bytes);
  if (below(8) == 0) bytes.resize(below(bytes.size() + 1));
  const bool mended = below(8) != 0;
  if (mended) mend_checksums(bytes);
  if (mended && below(4) == 0) damage(bytes);
  if (below(16) == 0) change_bytes(bytes);
  bytes.resize(std::min(bytes.size(), kMaxMutationBytes));
  return bytes;
}

// Returns a number that often causes faults in readers, such as a boundary value.
std::uint32_t Mutator::telling_number() {
  constexpr std::array<std::uint32_t, 14> kNumbers{
      0, 1, 2, 0x7f, 0x80, 0xff, 0x100, 0x7fff, 0x8000, 0xffff, 0x7fffffff, 0x80000000, 0xffffffff, 0x7f800000};
  return below(3) == 0 ? static_cast<std::uint32_t>(random_()) : kNumbers[below(kNumbers.size())];
}

// Returns a position. Half of the positions are within the first 64 bytes.
std::size_t Mutator::place(std::size_t size) { return below(below(2) == 0 ? std::min<std::size_t>(size, 64) : size); }

void Mutator::change_bytes(Bytes& bytes) {
  if (other_change_ && below(4) != 0) return other_change_(bytes);
  if (bytes.empty()) bytes.push_back(0);
  const std::size_t at = place(bytes.size());
  const auto here = bytes.begin() + static_cast<std::ptrdiff_t>(at);
  const std::size_t count = 1 + below(std::min<std::size_t>(below(4) == 0 ? 200 : 8, bytes.size() - at));
  switch (below(8)) {
    case 0:
      bytes[at] ^= static_cast<std::uint8_t>(1u << below(8));
      break;
    case 1:
      bytes[at] = static_cast<std::uint8_t>(random_());
      break;
    case 2:
      put_number(bytes, at, telling_number(), std::size_t{1} << below(3));
      break;
    case 3:
      bytes[at] = static_cast<std::uint8_t>(bytes[at] + (below(2) == 0 ? 1 : 255));
      break;
    case 4: {
      Bytes more(count);
      for (std::uint8_t& b : more) b = static_cast<std::uint8_t>(random_());
      bytes.insert(here, more.begin(), more.end());
      break;
    }
    case 5:
      bytes.erase(here, here + static_cast<std::ptrdiff_t>(count));
      break;
    case 6: {
      const Bytes again(here, here + static_cast<std::ptrdiff_t>(count));
      bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size() + 1)), again.begin(), again.end());
      break;
    }
    default:
      std::fill_n(here, count, below(2) == 0 ? std::uint8_t{0} : std::uint8_t{255});
      break;
  }
}

// Returns the start of `front`, followed by the end of `end`.
Bytes Mutator::spliced(const Bytes& front, const Bytes& end) {
  Bytes out(front.begin(), front.begin() + static_cast<std::ptrdiff_t>(below(front.size() + 1)));
  const std::size_t from = below(2) == 0 ? std::min(out.size(), end.size()) : below(end.size() + 1);
  out.insert(out.end(), end.begin() + static_cast<std::ptrdiff_t>(from), end.end());
  return out;
}

void Mutator::change_chunks(std::vector<Part>& chunks) {
  const std::vector<Part>& others = streams_[below(streams_.size())].chunks;
  if (chunks.empty()) {
    if (!others.empty()) chunks.push_back(others[below(others.size())]);
    return;
  }
  const std::size_t at = below(chunks.size());
  const auto anywhere = [&] { return chunks.begin() + static_cast<std::ptrdiff_t>(below(chunks.size() + 1)); };
  switch (below(9)) {
    case 0: {
      const Part again = chunks[at];
      chunks.insert(anywhere(), again);
      break;
    }
    case 1:
      chunks.erase(chunks.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 2:
      std::swap(chunks[at], chunks[below(chunks.size())]);
      break;
    case 3:
      std::shuffle(chunks.begin(), chunks.end(), random_);
      break;
    case 4:
      chunks[at].type = static_cast<std::uint16_t>(below(12));
      break;
    case 5:
      if (!others.empty()) chunks.insert(anywhere(), others[below(others.size())]);
      break;
    case 6:
      if (!others.empty()) chunks[at].bytes = spliced(chunks[at].bytes, others[below(others.size())].bytes);
      break;
    case 7:
      chunks[at].bytes = spliced(chunks[at].bytes, chunks[below(chunks.size())].bytes);
      break;
    default:
      chunks[at].bytes.resize(below(chunks[at].bytes.size() + 1));
      break;
  }
}

void Mutator::change(SeedStream& stream) {
  const std::size_t kind = below(16);
  if (kind == 0) {
    put_number(stream.fixed, 8 + below(kFixedHeader - 8), telling_number(), std::size_t{1} << below(3));
  } else if (kind == 1) {
    const std::vector<Part>& others = streams_[below(streams_.size())].sections;
    if (!others.empty() && below(2) == 0)
      stream.sections.insert(stream.sections.begin() + static_cast<std::ptrdiff_t>(below(stream.sections.size() + 1)),
                             others[below(others.size())]);
    else if (!stream.sections.empty())
      stream.sections.erase(stream.sections.begin() + static_cast<std::ptrdiff_t>(below(stream.sections.size())));
  } else if (kind < 4 && !stream.sections.empty()) {
    change_bytes(stream.sections[below(stream.sections.size())].bytes);
  } else if (kind < 7 || stream.chunks.empty()) {
    change_chunks(stream.chunks);
  } else {
    change_bytes(stream.chunks[below(stream.chunks.size())].bytes);
  }
}

// Changes one length of the container.
void Mutator::forge(Bytes& bytes) {
  if (bytes.size() < kFixedHeader + kChunkHead) return;
  std::vector<std::pair<std::size_t, std::size_t>> lengths{{kHeaderLength, 4}};
  const std::size_t header = std::min<std::size_t>(number_at(bytes, kHeaderLength, 4), bytes.size());
  for (std::size_t i = kFixedHeader; i + kSectionHead <= header; i += kSectionHead + number_at(bytes, i + 2, 4))
    lengths.emplace_back(i + 2, 4);
  for (std::size_t i = header; i + kChunkHead <= bytes.size(); i += kChunkHead + number_at(bytes, i + 2, 2))
    lengths.emplace_back(i + 2, 2);
  const auto [at, size] = lengths[below(lengths.size())];
  const std::uint32_t near = number_at(bytes, at, size) + static_cast<std::uint32_t>(below(9)) - 4;
  put_number(bytes, at, below(2) == 0 ? near : telling_number(), size);
}

// Changes a byte in the payload of one chunk, without its checksum.
void Mutator::damage(Bytes& bytes) {
  std::vector<std::size_t> payloads;
  const std::size_t header = bytes.size() < kFixedHeader ? bytes.size() : number_at(bytes, kHeaderLength, 4);
  for (std::size_t i = header; i + kChunkHead <= bytes.size(); i += kChunkHead + number_at(bytes, i + 2, 2))
    if (number_at(bytes, i + 2, 2) > 0 && i + kChunkHead < bytes.size()) payloads.push_back(i + kChunkHead);
  if (!payloads.empty()) bytes[payloads[below(payloads.size())]] ^= static_cast<std::uint8_t>(1 + below(255));
}

}  // namespace gs::fuzz
