#include "base/bytes.h"
#include "qnv/base/morton.h"
#include "qnv/base/palette.h"
#include "qnv/codecs/records/records_payload.h"
#include "qnv/sampling/order/order.h"
#include "qnv/sampling/order/order_points.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace gs::qnv {
namespace {

constexpr float kLargest = 1e37f;  // maximum position and weight; prevents overflow in small sums
constexpr unsigned kKeyBits = 3 * kDeepestRecordsCell;
constexpr std::size_t kVectorsPerTask = 1 << 14;

template <class Work>
void in_blocks(std::size_t count, unsigned threads, const Work& work) {
  parallel_for((count + kVectorsPerTask - 1) / kVectorsPerTask,
               [&](std::size_t b) { work(b * kVectorsPerTask, std::min(count, (b + 1) * kVectorsPerTask)); },
               count > kVectorsPerTask ? threads : 1);
}

bool can_be_sent(const glm::vec3& p, float weight) {
  return std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest && weight > 0 &&
         weight <= kLargest;
}

std::uint64_t key_of(const std::array<std::uint32_t, 3>& cell) { return morton_encode(cell[0], cell[1], cell[2]); }

// Returns the lowest key of the depth-20 cells inside a cell.
std::uint64_t first_key(const RecordsCell& cell) {
  return morton_encode(cell.x, cell.y, cell.z) << 3 * (kDeepestRecordsCell - cell.depth);
}
std::uint64_t key_count(const RecordsCell& cell) { return std::uint64_t{1} << 3 * (kDeepestRecordsCell - cell.depth); }

// Future chunk: a cell, and the ranks of its vectors in progressive order.
struct Group {
  std::uint8_t layer;
  RecordsCell cell;
  std::vector<std::uint32_t> ranks;  // ascending
};

// Ranks of the vectors of one layer, sorted by the keys of their cells.
using Keyed = std::span<const order::KeyedIndex>;

class Divider {
 public:
  Divider(std::size_t most, std::vector<Group>& groups) : most_(most), groups_(groups) {}

  void divide(std::uint8_t layer, const RecordsCell& cell, Keyed vectors) {
    if (vectors.size() <= most_ || cell.depth == kDeepestRecordsCell) {
      // Only vectors at almost the same position can exceed the limit here. Divides them among several chunks.
      for (; vectors.size() > most_; vectors = vectors.subspan(most_)) add(layer, cell, vectors.first(most_));
      add(layer, cell, vectors);
      return;
    }
    std::vector<order::KeyedIndex> scattered;
    for (unsigned octant = 0; octant < 8; ++octant) {
      const RecordsCell child{static_cast<std::uint8_t>(cell.depth + 1), 2 * cell.x + (octant & 1),
                              2 * cell.y + (octant >> 1 & 1), 2 * cell.z + (octant >> 2)};
      const std::uint64_t end = first_key(child) + key_count(child);
      const auto behind =
          std::partition_point(vectors.begin(), vectors.end(), [&](const order::KeyedIndex& v) { return v.key < end; });
      const auto count = static_cast<std::size_t>(behind - vectors.begin());
      const Keyed inside = vectors.first(count);
      vectors = vectors.subspan(count);
      if (count * 10 >= most_) {
        divide(layer, child, inside);
      } else {
        scattered.insert(scattered.end(), inside.begin(), inside.end());
      }
    }
    add(layer, cell, scattered);
  }

 private:
  void add(std::uint8_t layer, const RecordsCell& cell, Keyed vectors) {
    if (vectors.empty()) return;
    Group group{layer, cell, {}};
    group.ranks.reserve(vectors.size());
    for (const order::KeyedIndex& v : vectors) group.ranks.push_back(v.index);
    std::sort(group.ranks.begin(), group.ranks.end());
    groups_.push_back(std::move(group));
  }

  std::size_t most_;
  std::vector<Group>& groups_;
};

class RecordsEncoder {
 public:
  RecordsEncoder(const VectorView& vectors, const RecordsOptions& options)
      : vectors_(vectors), options_(options), cube_(vectors.description.box) {}

  std::vector<RecordsChunk> run() {
    list_vectors();
    if (order_.empty()) return {};
    find_keys();
    divide();
    if (cancelled()) return {};
    chunks_.resize(groups_.size());
    parallel_for(
        groups_.size(), [&](std::size_t i) { write(i); }, groups_.size() > 16 ? options_.threads : 1);
    write_cell_weights();
    if (cancelled()) return {};
    return std::move(chunks_);
  }

 private:
  [[nodiscard]] bool cancelled() const { return options_.progress && options_.progress->cancelled; }

  // Fills order_ with the indices of all vectors that can be encoded, in progressive order.
  void list_vectors() {
    std::vector<std::uint32_t> sendable;
    for (std::size_t i = 0; i < vectors_.size(); ++i)
      if (can_be_sent(vectors_.positions[i], vectors_.weights[i])) sendable.push_back(static_cast<std::uint32_t>(i));
    const OrderOptions options{options_.seed, vectors_.kind, options_.threads, options_.progress};
    if (sendable.size() == vectors_.size()) {
      order_ = progressive_order(vectors_.positions, vectors_.normals, vectors_.weights, options);
      return;
    }
    VectorArrays part;
    for (const std::uint32_t i : sendable) {
      part.positions.push_back(vectors_.positions[i]);
      part.normals.push_back(vectors_.normals[i]);
      part.weights.push_back(vectors_.weights[i]);
    }
    for (const std::uint32_t i : progressive_order(part.positions, part.normals, part.weights, options))
      order_.push_back(sendable[i]);
  }

  // Fills keys_ with the key of the depth-20 cell of each rank.
  void find_keys() {
    keys_.resize(order_.size());
    in_blocks(order_.size(), options_.threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t rank = first; rank < last; ++rank)
        keys_[rank] = key_of(cube_.cell_of(vectors_.positions[order_[rank]]));
    });
  }

  void divide() {
    const std::size_t most = std::clamp<std::size_t>(options_.most_per_chunk, 16, 8000);
    const std::size_t wanted = std::min(options_.vectors, order_.size());
    Divider divider(most, groups_);
    std::size_t first = 0, last = std::max<std::size_t>(options_.first_layer, 1);
    for (std::uint8_t layer = 0; first < wanted; ++layer) {
      last = std::min(last, wanted);
      std::vector<order::KeyedIndex> vectors(last - first);
      for (std::size_t i = first; i < last; ++i) vectors[i - first] = {keys_[i], static_cast<std::uint32_t>(i)};
      order::sort_by_key(vectors, kKeyBits, options_.threads);
      divider.divide(layer, {}, vectors);
      first = last;
      last = last > wanted / 4 ? wanted : 4 * last;
    }
    std::sort(groups_.begin(), groups_.end(), [](const Group& a, const Group& b) {
      return a.layer != b.layer ? a.layer < b.layer : a.ranks.front() < b.ranks.front();
    });
  }

  void write(std::size_t i) {
    const Group& group = groups_[i];
    const std::size_t count = group.ranks.size();
    std::vector<glm::vec3> positions(count), normals(count);
    std::vector<float> weights(count);
    std::vector<Rgb8> rgb;
    std::vector<std::uint8_t> colors;
    Box box;
    float largest = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t from = order_[group.ranks[k]];
      box.add(positions[k] = vectors_.positions[from]);
      normals[k] = vectors_.normals[from];
      largest = std::max(largest, weights[k] = vectors_.weights[from]);
      if (!vectors_.classes.empty())
        colors.push_back(vectors_.classes[from]);
      else if (!options_.palette.empty() && !vectors_.colors.empty())
        rgb.push_back(vectors_.colors[from]);
    }
    if (!rgb.empty()) colors = palette_indices(rgb, options_.palette, 1);
    RecordsChunk& chunk = chunks_[i];
    chunk.header = {group.layer, static_cast<std::uint16_t>(count), group.cell, frame_for(box, largest), 0};
    chunk.payload.resize(kRecordsHeaderBytes + count * kRecordBytes);
    const auto records = std::span(chunk.payload).subspan(kRecordsHeaderBytes);
    pack_records(positions, normals, weights, colors, chunk.header.frame, records.data());
    // From here on, positions are as a decoder computes them.
    colors.resize(count);
    unpack_records(records, chunk.header.frame, positions.data(), normals.data(), weights.data(), colors.data());
    for (std::size_t k = 0; k < count; ++k) keys_[group.ranks[k]] = key_of(cube_.cell_of(positions[k], group.cell));
  }

  void write_cell_weights() {
    std::vector<order::KeyedIndex> sorted(order_.size());
    for (std::size_t rank = 0; rank < order_.size(); ++rank)
      sorted[rank] = {keys_[rank], static_cast<std::uint32_t>(rank)};
    order::sort_by_key(sorted, kKeyBits, options_.threads);
    std::vector<double> sums{0};
    sums.reserve(sorted.size() + 1);
    for (const order::KeyedIndex& v : sorted) sums.push_back(sums.back() + vectors_.weights[order_[v.index]]);
    const auto sum_before = [&](std::uint64_t key) {
      const auto at =
          std::partition_point(sorted.begin(), sorted.end(), [&](const order::KeyedIndex& v) { return v.key < key; });
      return sums[static_cast<std::size_t>(at - sorted.begin())];
    };
    for (RecordsChunk& chunk : chunks_) {
      RecordsHeader& header = chunk.header;
      const std::uint64_t first = first_key(header.cell);
      const double weight = sum_before(first + key_count(header.cell)) - sum_before(first);
      header.cell_weight = static_cast<float>(std::min<double>(weight, std::numeric_limits<float>::max()));
      write_header(header, chunk.payload);
    }
  }

  static void write_header(const RecordsHeader& header, std::vector<std::byte>& payload) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    out.integer(header.layer);
    out.integer(header.cell.depth);
    out.integer(header.count);
    for (const std::uint32_t at : {header.cell.x, header.cell.y, header.cell.z}) out.integer(at);
    for (int axis = 0; axis < 3; ++axis) out.f32(header.frame.lower[axis]);
    for (int axis = 0; axis < 3; ++axis) out.f32(header.frame.cell[axis]);
    out.f32(header.frame.weight_step);
    out.f32(header.cell_weight);
    std::copy(bytes.begin(), bytes.end(), payload.begin());
  }

  const VectorView vectors_;
  const RecordsOptions& options_;
  const RecordsCube cube_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint64_t> keys_;
  std::vector<Group> groups_;
  std::vector<RecordsChunk> chunks_;
};

}  // namespace

std::vector<RecordsChunk> encode_records(const VectorView& vectors, const RecordsOptions& options) {
  return RecordsEncoder(vectors, options).run();
}

}  // namespace gs::qnv
