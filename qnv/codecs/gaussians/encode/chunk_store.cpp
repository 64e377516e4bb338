#include "qnv/codecs/gaussians/encode/chunk_store.h"

#include "qnv/container/cluster_directory.h"

#include <glm/common.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>
#include <utility>

namespace gs::qnv::gaussians {
namespace {

/// Candidate for the next chunk of the stream.
struct ChunkCandidate {
  std::uint32_t use = 0;     // rank_of() of the gain per byte
  std::uint32_t parent = 0;  // identifier
  std::uint32_t record = 0;
};

/// Head of a result of ChunkRecords::finish(). The records and the indices of the clusters follow.
struct FinishedHead {
  std::uint32_t first_id = 0, records = 0, clusters = 0, unused = 0;
  std::uint64_t bytes = 0;
};

// Rounds a gain per byte down to four steps per octave. Chunks of equal rank have the order of their parents. So the
// children of a cluster are consecutive, and the directory is short.
std::uint32_t rank_of(double use) {
  constexpr int kBelow = 50;  // dropped bits of the fraction
  return use > 0 ? static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(use) >> kBelow) : 0;
}

template <class T>
void append_items(std::vector<std::byte>& to, std::span<const T> items) {
  const auto bytes = std::as_bytes(items);
  to.insert(to.end(), bytes.begin(), bytes.end());
}

template <class T>
std::vector<T> items_at(std::span<const std::byte> from, std::size_t count) {
  std::vector<T> items(count);
  if (count > 0) std::memcpy(static_cast<void*>(items.data()), from.data(), count * sizeof(T));
  return items;
}

}  // namespace

std::optional<std::uint64_t> SharedStore::add(std::span<const std::byte> bytes) {
  const std::scoped_lock lock(mutex_);
  const std::uint64_t offset = store_.size();
  return store_.append(bytes) ? std::optional(offset) : std::nullopt;
}

bool SharedStore::read(std::uint64_t offset, std::span<std::byte> to) const {
  const std::scoped_lock lock(mutex_);
  return store_.read(offset, to);
}

std::optional<std::uint64_t> SharedStore::finish(std::string_view work, std::span<const std::byte> bytes,
                                                 std::span<const std::byte> result) {
  const std::scoped_lock lock(mutex_);
  const std::uint64_t offset = store_.size();
  std::vector<std::byte> record;
  append_items(record, std::span(&offset, 1));
  append_items(record, result);
  return store_.append(bytes) && store_.finish(work, offset, record) ? std::optional(offset) : std::nullopt;
}

// Takes no lock, because it reads only results of earlier runs. No thread changes them.
std::optional<SharedStore::Finished> SharedStore::finished(std::string_view work) const {
  auto record = store_.finished(work);
  Finished found;
  if (!record || record->size() < sizeof found.offset) return std::nullopt;
  std::memcpy(&found.offset, record->data(), sizeof found.offset);
  record->erase(record->begin(), record->begin() + sizeof found.offset);
  found.result = std::move(*record);
  return found;
}

std::string SharedStore::problem() const {
  const std::scoped_lock lock(mutex_);
  return store_.problem();
}

bool ChunkRecords::add(const EncodedCluster& cluster, std::span<const EncodedHarmonics> harmonics, const Box& box) {
  const bool root = cluster.head.parent == ClusterHead::kNoParent;
  ChunkRecord record;
  record.level = cluster.head.level;
  record.parent = cluster.head.parent;
  record.first = cluster.head.first;
  record.count = cluster.head.count;
  record.vectors = static_cast<std::uint32_t>(cluster.nodes.size());
  record.replaced = root ? 0 : cluster.replaced;
  record.gain = cluster.gain;
  record.box = box;
  const auto store = [&](std::span<const std::byte> bytes) {
    const auto offset = store_.add(bytes);
    record.offset = offset.value_or(0);
    record.bytes = static_cast<std::uint32_t>(bytes.size());
    records_.push_back(record);
    return offset.has_value();
  };
  clusters_.push_back(static_cast<std::uint32_t>(records_.size()));
  if (!store(cluster.bytes)) return false;
  record.vectors = record.replaced = 0;
  record.parent = cluster.head.id;
  for (const EncodedHarmonics& chunk : harmonics) {
    record.type = chunk.type;
    record.first = chunk.first;
    record.count = chunk.count;
    record.gain = chunk.gain;
    if (!store(chunk.bytes)) return false;
  }
  return true;
}

std::unique_ptr<ChunkRecords> ChunkRecords::finish(std::string_view work, const SpillStore& bytes,
                                                   SharedStore& store) const {
  std::vector<std::byte> all(static_cast<std::size_t>(bytes.size())), result;
  if (!bytes.read(0, all)) return nullptr;
  const FinishedHead head{first_id_, static_cast<std::uint32_t>(records_.size()),
                          static_cast<std::uint32_t>(clusters_.size()), 0, all.size()};
  append_items(result, std::span(&head, 1));
  append_items(result, records());
  append_items(result, clusters());
  const auto offset = store.finish(work, all, result);
  if (!offset) return nullptr;
  auto moved = std::make_unique<ChunkRecords>(store, first_id_, records_, clusters_);
  for (ChunkRecord& record : moved->records_) record.offset += *offset;
  return moved;
}

std::unique_ptr<ChunkRecords> ChunkRecords::finished(std::string_view work, std::uint32_t first_id,
                                                     SharedStore& store) {
  const auto found = store.finished(work);
  if (!found || found->result.size() < sizeof(FinishedHead)) return nullptr;
  const std::span<const std::byte> rest(found->result);
  const FinishedHead head = items_at<FinishedHead>(rest, 1).front();
  const std::size_t all = head.records * sizeof(ChunkRecord);
  if (head.first_id != first_id || rest.size() != sizeof head + all + head.clusters * sizeof(std::uint32_t))
    return nullptr;
  auto kept = std::make_unique<ChunkRecords>(store, first_id);
  kept->records_ = items_at<ChunkRecord>(rest.subspan(sizeof head), head.records);
  kept->clusters_ = items_at<std::uint32_t>(rest.subspan(sizeof head + all), head.clusters);
  for (ChunkRecord& record : kept->records_) {
    if (record.offset > head.bytes || record.bytes > head.bytes - record.offset) return nullptr;
    record.offset += found->offset;
  }
  const bool in_range = std::ranges::all_of(kept->clusters_, [&](std::uint32_t i) { return i < head.records; });
  return in_range ? std::move(kept) : nullptr;
}

void ChunkRecords::append_to(std::vector<ChunkRecord>& all, std::vector<std::uint32_t>& clusters) const {
  const auto first = static_cast<std::uint32_t>(all.size());
  for (ChunkRecord record : records_) {
    if (record.parent != ClusterHead::kNoParent)
      record.parent =
          record.parent < first_id_ ? clusters[record.parent] : first + clusters_[record.parent - first_id_];
    all.push_back(record);
  }
  if (first_id_ == 0) clusters = clusters_;
}

OrderedChunks::OrderedChunks(std::vector<ChunkRecord> records, std::size_t most_vectors, const SharedStore& store)
    : records_(std::move(records)), store_(store) {
  find_order(most_vectors);
  add_gains();
}

void OrderedChunks::find_order(std::size_t most_vectors) {
  // Groups the records by their parents.
  const std::size_t count = records_.size();
  std::vector<std::uint32_t> starts(count + 1), children(count);
  for (const ChunkRecord& record : records_)
    if (record.parent < count) ++starts[record.parent + 1];
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  std::vector<std::uint32_t> ends(starts.begin(), starts.end() - 1);
  for (std::uint32_t i = 0; i < count; ++i)
    if (records_[i].parent < count) children[ends[records_[i].parent]++] = i;
  std::vector<ChunkCandidate> heap;  // the most useful one is first
  const auto less = [&](const ChunkCandidate& a, const ChunkCandidate& b) {
    const ChunkRecord &p = records_[a.record], &q = records_[b.record];
    if (a.use != b.use) return a.use < b.use;
    if (a.parent != b.parent) return a.parent > b.parent;
    return p.first != q.first ? p.first > q.first : p.type > q.type;
  };
  const auto add = [&](std::uint32_t i, std::uint32_t parent) {
    heap.push_back({rank_of(use_of(records_[i].gain, records_[i].bytes)), parent, i});
    std::ranges::push_heap(heap, less);
  };
  for (std::uint32_t i = 0; i < count; ++i)
    if (records_[i].parent == ClusterHead::kNoParent) add(i, ClusterHead::kNoParent);
  ids_.assign(count, ClusterHead::kNoParent);
  order_.reserve(count);
  std::size_t shown = 0;
  for (std::uint32_t id = 0; !heap.empty();) {
    std::ranges::pop_heap(heap, less);
    const std::uint32_t next = heap.back().record;
    heap.pop_back();
    const ChunkRecord& record = records_[next];
    if (record.type == ChunkType::gaussians) {
      if (most_vectors != 0 && shown >= most_vectors) continue;
      shown += record.vectors - record.replaced;
      ids_[next] = id++;
    }
    order_.push_back(next);
    for (std::uint32_t i = starts[next]; i < starts[next + 1]; ++i) add(children[i], ids_[next]);
  }
}

// Adds the gain of each chunk to the gain of the cluster that it requires.
void OrderedChunks::add_gains() {
  for (ChunkRecord& record : records_) record.gain = std::max(record.gain, 0.0);
  for (std::size_t i = order_.size(); i-- > 0;) {
    const ChunkRecord& record = records_[order_[i]];
    if (record.parent != ClusterHead::kNoParent) records_[record.parent].gain += record.gain;
  }
}

std::optional<OutgoingChunk> OrderedChunks::chunk(std::size_t i) const {
  const ChunkRecord& record = records_[order_[i]];
  std::vector<std::byte> bytes(record.bytes);
  if (!store_.read(record.offset, bytes)) return std::nullopt;
  return packed(i, bytes);
}

std::optional<OutgoingChunk> OrderedChunks::outline(std::size_t i) const {
  return packed(i, std::vector<std::byte>(records_[order_[i]].bytes));
}

std::optional<Listing> OrderedChunks::listing(std::span<const DirectoryEntry> entries, const Box& box) const {
  auto payloads = pack_clusters(entries, box);
  if (!payloads) return std::nullopt;
  std::size_t bytes = 0;
  for (const std::vector<std::byte>& payload : *payloads) bytes += kChunkHeaderBytes + payload.size();
  if (bytes > entries.size() * entry_bytes()) return std::nullopt;
  return Listing{ChunkType::cluster_directory, std::move(*payloads)};
}

OutgoingChunk OrderedChunks::packed(std::size_t i, std::span<const std::byte> bytes) const {
  const ChunkRecord& record = records_[order_[i]];
  const bool root = record.parent == ClusterHead::kNoParent;
  const std::uint32_t parent = root ? record.parent : ids_[record.parent];
  OutgoingChunk chunk;
  chunk.type = record.type;
  if (record.type == ChunkType::gaussians)
    chunk.payload = pack(ClusterHead{ids_[order_[i]], parent, record.first, record.count, record.level}, bytes);
  else
    chunk.payload = pack(HarmonicsHead{parent, record.first, record.count}, bytes);
  chunk.entry.level = static_cast<std::uint8_t>(std::min<std::uint32_t>(record.level, 255));
  chunk.entry.parent = parent;
  chunk.entry.vectors = record.vectors;
  chunk.entry.box = record.box;
  chunk.replaced = record.replaced;
  chunk.gain = record.gain;
  return chunk;
}

Box bounds_of(std::span<const SplatNode> nodes, const Box& whole) {
  constexpr float kReach = 3;  // standard deviations
  Box box;
  for (const SplatNode& node : nodes) {
    const glm::vec3 reach(kReach * static_cast<float>(scale_of(node.scales[0])));
    const glm::vec3 lower = node.position - reach, upper = node.position + reach;
    box.add(glm::max(lower, whole.lower));
    box.add(glm::min(upper, whole.upper));
  }
  return box;
}

}  // namespace gs::qnv::gaussians
