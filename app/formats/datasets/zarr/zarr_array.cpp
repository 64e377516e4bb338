#include "app/formats/datasets/zarr/zarr_array.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMostChunkRequests = 64;                      // that wait for a server at once
constexpr std::uint64_t kMostChunkBatch = std::uint64_t{64} << 20;  // decoded bytes of one batch of requests
constexpr std::size_t kMostShardIndices = 64;                       // of shards in memory
constexpr std::uint64_t kNoChunk = std::numeric_limits<std::uint64_t>::max();

std::uint64_t number_in_index(std::span<const std::byte> bytes, std::size_t at, std::size_t count, bool big_endian) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
    value = value << 8 | std::to_integer<std::uint64_t>(bytes[at + (big_endian ? i : count - 1 - i)]);
  return value;
}

/// Returns the strides of the dimensions for a chunk of this shape.
std::vector<std::uint64_t> zarr_strides(const ZarrArray& array, std::span<const std::uint64_t> shape) {
  std::vector<std::uint64_t> strides(shape.size());
  std::uint64_t stride = 1;
  for (std::size_t i = array.order.size(); i-- > 0;) {
    strides[array.order[i]] = stride;
    stride *= shape[array.order[i]];
  }
  return strides;
}

/// Reverses the bytes of each number.
void swap_numbers(std::span<std::byte> bytes, std::size_t size) {
  const auto swap = [&]<class T>(T, auto reversed) {
    for (std::size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
      T value;
      std::memcpy(&value, bytes.data() + at, sizeof(T));
      value = reversed(value);
      std::memcpy(bytes.data() + at, &value, sizeof(T));
    }
  };
  if (size == 2) swap(std::uint16_t{}, [](std::uint16_t value) { return __builtin_bswap16(value); });
  if (size == 4) swap(std::uint32_t{}, [](std::uint32_t value) { return __builtin_bswap32(value); });
  if (size == 8) swap(std::uint64_t{}, [](std::uint64_t value) { return __builtin_bswap64(value); });
}

std::vector<std::byte> zarr_nan(const ZarrArray& array) {
  std::vector<std::byte> element = array.fill;
  if (array.type.stored != StoredType::f32 && array.type.stored != StoredType::f64) return element;
  element.clear();
  for (std::size_t i = 0; i < array.type.components; ++i) {
    std::vector<std::byte> number(size_of(array.type.stored));
    if (number.size() == sizeof(float)) {
      const float nan = std::numeric_limits<float>::quiet_NaN();
      std::memcpy(number.data(), &nan, sizeof(nan));
    } else {
      const double nan = std::numeric_limits<double>::quiet_NaN();
      std::memcpy(number.data(), &nan, sizeof(nan));
    }
    if (array.type.big_endian != (std::endian::native == std::endian::big)) std::ranges::reverse(number);
    element.insert(element.end(), number.begin(), number.end());
  }
  return element;
}

}  // namespace

ZarrReader::ZarrReader(std::string folder, ZarrArray array, ReadFiles read, WorldBudget budget)
    : folder_(std::move(folder)),
      array_(std::move(array)),
      read_(std::move(read)),
      budget_(std::move(budget)),
      strides_(zarr_strides(array_, array_.chunk)),
      bad_(zarr_nan(array_)) {}

void ZarrReader::note(const std::string& file, const std::string& problem) {
  if (failed_++ == 0) first_problem_ = file + ": " + problem;
}

std::string ZarrReader::trouble() const {
  const std::lock_guard lock(mutex_);
  if (failed_ == 0) return {};
  return std::to_string(failed_) + (failed_ == 1 ? " chunk" : " chunks") + " cannot be read and " +
         (failed_ == 1 ? "is" : "are") + " drawn as missing; the first one: " + first_problem_;
}

// Zarr 2: "0.1.2" or "0/1/2"; Zarr 3: "c/0/1/2"; N5: "2/1/0".
std::string ZarrReader::file_of(const Key& key) const {
  std::string name = folder_ + array_.key_prefix;
  for (std::size_t i = 0; i < key.size(); ++i) {
    if (i > 0 || !array_.key_prefix.empty()) name += array_.key_separator;
    name += std::to_string(key[array_.n5 ? key.size() - 1 - i : i]);
  }
  return name;
}

const ZarrReader::Index& ZarrReader::index_of(const Key& shard) {
  if (const auto known = indices_.find(shard); known != indices_.end()) return known->second;
  if (indices_.size() >= kMostShardIndices) indices_.clear();
  Index& index = indices_[shard];
  std::uint64_t count = 1;
  for (std::size_t i = 0; i < shard.size(); ++i) count *= array_.shards->shape[i] / array_.chunk[i];
  constexpr std::uint64_t kEntry = 16;
  FileRequest wanted{file_of(shard)};
  wanted.part = FilePart{0, count * kEntry + (array_.shards->index_has_checksum ? 4 : 0), array_.shards->index_at_end};
  std::vector<FileResult> results = read_({&wanted, 1});
  if (std::holds_alternative<NoFile>(results.front())) {
    index.absent = true;
  } else if (const auto* const problem = std::get_if<std::string>(&results.front())) {
    index.problem = *problem;
  } else {
    std::optional<std::span<const std::byte>> bytes = std::get<SharedBytes>(results.front()).bytes;
    if (array_.shards->index_has_checksum) bytes = without_crc32c(*bytes);
    if (!bytes) {
      index.problem = "the checksum of its index differs";
    } else {
      for (std::size_t at = 0; at + kEntry <= bytes->size(); at += kEntry)
        index.places.emplace_back(number_in_index(*bytes, at, 8, false), number_in_index(*bytes, at + 8, 8, false));
      index.places.resize(static_cast<std::size_t>(count), {kNoChunk, kNoChunk});
    }
  }
  return index;
}

std::optional<FileResult> ZarrReader::request(const Key& key, FileRequest& wanted) {
  if (!array_.shards) {
    wanted.reference = file_of(key);
    return std::nullopt;
  }
  Key shard(key.size());
  std::size_t inside = 0;
  for (std::size_t i = 0; i < key.size(); ++i) {
    const std::uint64_t along = array_.shards->shape[i] / array_.chunk[i];
    shard[i] = key[i] / along;
    inside = inside * static_cast<std::size_t>(along) + static_cast<std::size_t>(key[i] % along);
  }
  const Index& index = index_of(shard);
  if (!index.problem.empty()) return FileResult(index.problem);
  if (index.absent || index.places[inside] == std::pair(kNoChunk, kNoChunk)) return FileResult(NoFile());
  wanted.reference = file_of(shard);
  wanted.part = FilePart{index.places[inside].first, index.places[inside].second};
  return std::nullopt;
}

void ZarrReader::decode(const Key& key, FileResult file, Chunk& chunk) {
  if (std::holds_alternative<NoFile>(file)) return;
  const auto fail = [&](const std::string& problem) {
    note(file_of(key), problem);
    chunk.failed = true;
  };
  if (const auto* const problem = std::get_if<std::string>(&file)) {
    fail(*problem);
    return;
  }
  std::span<const std::byte> bytes = std::get<SharedBytes>(file).bytes;
  std::uint64_t elements = array_.chunk_elements();
  std::vector<std::uint64_t> shape = array_.chunk;
  if (array_.n5) {
    // Header of a block: mode, number of dimensions, then the size in each dimension; big endian.
    const std::size_t count = shape.size(), header = 4 + 4 * count;
    if (bytes.size() < header || number_in_index(bytes, 0, 2, true) != 0 ||
        number_in_index(bytes, 2, 2, true) != count) {
      fail("it does not begin with the header of an N5 block");
      return;
    }
    elements = 1;
    for (std::size_t i = 0; i < count; ++i) {
      shape[count - 1 - i] = number_in_index(bytes, 4 + 4 * i, 4, true);
      if (shape[count - 1 - i] > array_.chunk[count - 1 - i]) {
        fail("its header has a larger block than the array");
        return;
      }
      elements *= shape[count - 1 - i];
    }
    bytes = bytes.subspan(header);
  }
  const std::uint64_t whole = array_.chunk_elements() * array_.type.bytes();
  auto result = decode_zarr_chunk(array_, bytes, elements);
  if (auto* const problem = std::get_if<std::string>(&result)) {
    fail(*problem);
    return;
  }
  chunk.elements = std::move(std::get<std::vector<std::byte>>(result));
  if (shape == array_.chunk) return;
  // A smaller block at the end of the array: give it the shape of the others.
  const std::size_t size = array_.type.bytes();
  std::vector<std::byte> padded(static_cast<std::size_t>(whole));
  const std::vector<std::uint64_t> from = zarr_strides(array_, shape);
  for (std::uint64_t i = 0; i < elements; ++i) {
    std::uint64_t rest = i, to = 0;
    for (std::size_t d = 0; d < shape.size(); ++d) {
      to += rest / from[d] * strides_[d];
      rest %= from[d];
    }
    std::memcpy(padded.data() + to * size, chunk.elements.data() + i * size, size);
  }
  chunk.elements = std::move(padded);
}

const ZarrReader::Chunk* ZarrReader::find(const Key& key) {
  const auto at = places_.find(key);
  if (at == places_.end()) return nullptr;
  chunks_.splice(chunks_.begin(), chunks_, at->second);
  return &at->second->second;
}

bool ZarrReader::keep(const Key& key, FileResult file) {
  Chunk chunk{{}, false, Share(budget_, Resource::volumes)};
  const bool empty = !std::holds_alternative<SharedBytes>(file);
  const std::uint64_t bytes =
      (empty ? 0 : array_.chunk_elements() * array_.type.bytes()) + key.size() * sizeof(key[0]) + sizeof(Entry);
  // Half of what is left belongs to others.
  while (!chunks_.empty() && bytes > budget_->left(Resource::volumes) / 2) {
    places_.erase(chunks_.back().first);
    chunks_.pop_back();
  }
  if (!chunk.share.grow(bytes)) return false;
  decode(key, std::move(file), chunk);
  chunks_.emplace_front(key, std::move(chunk));
  places_[key] = chunks_.begin();
  return true;
}

std::size_t ZarrReader::fetch(std::span<const Key> keys) {
  const std::uint64_t each = std::max<std::uint64_t>(array_.chunk_elements() * array_.type.bytes(), 1);
  const std::size_t most = std::clamp(static_cast<std::size_t>(kMostChunkBatch / each), std::size_t{1},
                                      std::min(kMostChunkRequests, keys.size()));
  std::vector<FileRequest> wanted;
  std::vector<const Key*> waiting;
  for (const Key& key : keys.first(most)) {
    if (places_.contains(key)) continue;
    FileRequest one;
    if (auto known = request(key, one)) {
      if (!keep(key, std::move(*known))) return 0;
      continue;
    }
    wanted.push_back(std::move(one));
    waiting.push_back(&key);
  }
  if (wanted.empty()) return most;
  std::vector<FileResult> results = read_(wanted);
  if (budget_->stopped()) return 0;
  results.resize(wanted.size(), std::string("it was not read"));
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (!keep(*waiting[i], std::move(results[i]))) return 0;
  return most;
}

void ZarrReader::copy(std::span<const std::uint64_t> first, std::span<const std::uint64_t> count, const Key& key,
                      const Chunk& chunk, std::span<std::byte> to) const {
  const std::size_t element = array_.type.bytes(), dimensions = key.size(), last = dimensions - 1;
  // The part of the box in this chunk, in elements of the array.
  std::vector<std::uint64_t> begin(dimensions), end(dimensions), at(dimensions), out(dimensions);
  std::uint64_t stride = element;
  for (std::size_t d = dimensions; d-- > 0;) {
    begin[d] = std::max(first[d], key[d] * array_.chunk[d]);
    end[d] = std::min(first[d] + count[d], (key[d] + 1) * array_.chunk[d]);
    out[d] = stride;
    stride *= count[d];
  }
  const std::vector<std::byte>& filler = chunk.failed ? bad_ : array_.fill;
  const std::uint64_t step = strides_[last] * element, length = end[last] - begin[last];
  at = begin;
  for (bool more = true; more;) {
    std::byte* row = to.data();
    const std::byte* from = chunk.elements.data();
    for (std::size_t d = 0; d < dimensions; ++d) {
      row += (at[d] - first[d]) * out[d];
      if (!chunk.elements.empty()) from += at[d] % array_.chunk[d] * strides_[d] * element;
    }
    if (chunk.elements.empty())
      for (std::uint64_t i = 0; i < length; ++i) std::memcpy(row + i * element, filler.data(), element);
    else if (step == element)
      std::memcpy(row, from, static_cast<std::size_t>(length) * element);
    else
      for (std::uint64_t i = 0; i < length; ++i) std::memcpy(row + i * element, from + i * step, element);
    more = false;
    for (std::size_t d = last; d-- > 0 && !more;) {
      more = ++at[d] < end[d];
      if (!more) at[d] = begin[d];
    }
  }
}

bool ZarrReader::read(std::span<const std::uint64_t> first, std::span<const std::uint64_t> count,
                      std::span<std::byte> to) {
  const std::lock_guard lock(mutex_);
  const std::size_t dimensions = array_.shape.size();
  std::uint64_t bytes = array_.type.bytes(), boxes = 1;
  if (first.size() != dimensions || count.size() != dimensions) return false;
  Key low(dimensions), high(dimensions);
  for (std::size_t d = 0; d < dimensions; ++d) {
    if (count[d] == 0 || first[d] >= array_.shape[d] || count[d] > array_.shape[d] - first[d]) return false;
    low[d] = first[d] / array_.chunk[d];
    high[d] = (first[d] + count[d] - 1) / array_.chunk[d];
    if (count[d] > to.size() / bytes) return false;
    bytes *= count[d];
    boxes *= high[d] - low[d] + 1;  // at most the number of elements
  }
  if (bytes != to.size()) return false;
  Key next = low;
  const auto advance = [&] {
    for (std::size_t d = dimensions; d-- > 0;) {
      if (++next[d] <= high[d]) return;
      next[d] = low[d];
    }
  };
  while (boxes > 0) {
    if (budget_->stopped()) return false;
    std::vector<Key> keys;
    for (; boxes > 0 && keys.size() < kMostChunkRequests; --boxes, advance()) keys.push_back(next);
    for (std::size_t done = 0; done < keys.size();) {
      const std::size_t fetched = fetch(std::span(keys).subspan(done));
      if (fetched == 0) return false;
      for (const Key& key : std::span(keys).subspan(done, fetched)) {
        // Chunks of a batch may push each other out of memory.
        if (!find(key) && fetch({&key, 1}) == 0) return false;
        const Chunk* const chunk = find(key);
        if (!chunk) return false;
        copy(first, count, key, *chunk, to);
      }
      done += fetched;
    }
  }
  if (array_.type.big_endian != (std::endian::native == std::endian::big))
    swap_numbers(to, size_of(array_.type.stored));
  return true;
}

}  // namespace gs::app
