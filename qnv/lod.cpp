#include "qnv/lod.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <utility>

namespace gs::qnv {
namespace {

bool outside(const Box& box, const LodView& view) {
  for (const glm::vec4& plane : view.planes) {
    if (plane == glm::vec4(0)) continue;
    // The corner that lies furthest inwards.
    const glm::vec3 p(plane.x >= 0 ? box.upper.x : box.lower.x, plane.y >= 0 ? box.upper.y : box.lower.y,
                      plane.z >= 0 ? box.upper.z : box.lower.z);
    if (plane.x * p.x + plane.y * p.y + plane.z * p.z + plane.w < 0) return true;
  }
  return false;
}

float distance_to(const Box& box, const glm::vec3& p) {
  glm::vec3 d(0);
  for (int i = 0; i < 3; ++i) d[i] = std::max({box.lower[i] - p[i], p[i] - box.upper[i], 0.0f});
  return std::sqrt(glm::dot(d, d));
}

}  // namespace

std::variant<std::unique_ptr<LodStream>, StreamProblem> LodStream::open(std::vector<std::byte> bytes,
                                                                        std::size_t cache_discs) {
  std::size_t header_bytes = 0;
  bool need_more = false;
  auto header = decode_header(bytes, header_bytes, need_more);
  if (auto* problem = std::get_if<StreamProblem>(&header)) return std::move(*problem);
  std::unique_ptr<LodStream> stream(new LodStream);
  stream->header_ = std::move(std::get<StreamHeader>(header));
  stream->cache_discs_ = cache_discs;
  if (stream->header_.payload != Payload::packed)
    return StreamProblem{11, "a stream of records has no levels of detail; expected a packed one"};
  stream->bytes_ = std::move(bytes);
  stream->scan();
  if (stream->nodes_.empty()) return StreamProblem{header_bytes, "holds no cluster that stands at the top"};
  return stream;
}

void LodStream::scan() {
  const std::span<const std::byte> bytes(bytes_);
  std::map<std::uint32_t, std::uint32_t> index_of;    // by the number of the cluster
  std::map<std::uint64_t, DirectoryEntry> directory;  // by offset
  std::vector<std::pair<std::uint64_t, std::uint32_t>> offsets;
  StreamReader reader;
  // The reader checks every checksum, so that damage is found here and not in the middle of a frame.
  const auto take = [&](ChunkType type, std::span<const std::byte>, std::uint64_t offset) {
    const auto payload = [&](std::size_t length) {
      return bytes.subspan(static_cast<std::size_t>(offset) + kChunkHeaderBytes, length);
    };
    const std::size_t length = std::to_integer<std::size_t>(bytes[static_cast<std::size_t>(offset) + 2]) |
                               std::to_integer<std::size_t>(bytes[static_cast<std::size_t>(offset) + 3]) << 8;
    if (type == ChunkType::directory) {
      for (const DirectoryEntry& entry : decode_directory(payload(length), header_.description.box))
        directory.emplace(entry.offset, entry);
      return;
    }
    if (type != ChunkType::packed) return;
    const auto read = read_cluster_header(payload(length));
    const auto* cluster = std::get_if<ClusterHeader>(&read);
    if (!cluster || index_of.contains(cluster->id)) return;
    Node node;
    node.payload = payload(length);
    node.cluster = *cluster;
    if (cluster->parent != kNoParent) {
      const auto parent = index_of.find(cluster->parent);
      if (parent == index_of.end()) return;
      node.parent = parent->second;
    } else if (!nodes_.empty()) {
      return;
    }
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    index_of.emplace(cluster->id, index);
    offsets.emplace_back(offset, index);
    if (node.parent != kNoParent) nodes_[node.parent].children.push_back(index);
    nodes_.push_back(std::move(node));
  };
  reader.push(bytes, take);
  reader.finish(take);
  problems_ = reader.problems();
  for (const auto& [offset, index] : offsets) {
    Node& node = nodes_[index];
    const auto entry = directory.find(offset);
    if (entry != directory.end()) {
      node.box = entry->second.box;
      node.voxels = entry->second.vectors;
    } else if (decode(index)) {  // the directory has not come
      node.voxels = static_cast<std::uint32_t>(node.decoded->voxels.size());
    }
  }
}

// With its ancestors. False when it cannot be.
bool LodStream::decode(std::uint32_t index) {
  Node& node = nodes_[index];
  if (node.broken) return false;
  if (node.cloud) return true;
  const Cluster* parent = nullptr;
  if (node.parent != kNoParent) {
    if (!decode(node.parent)) return false;  // no deeper than the octree
    parent = nodes_[node.parent].decoded.get();
  }
  auto decoded = decode_cluster(node.payload, parent);
  auto* cluster = std::get_if<Cluster>(&decoded);
  if (!cluster) {
    node.broken = true;
    problems_.push_back({0, std::get<PackedError>(decoded).message});
    return false;
  }
  node.decoded = std::make_unique<Cluster>(std::move(*cluster));
  auto cloud = std::make_shared<Cloud>();
  cloud->description.kind = header_.description.kind;
  cloud->description.two_sided = header_.description.two_sided;
  cloud->color = header_.color;
  node.first_disc.clear();
  for (std::size_t i = 0; i < node.decoded->voxels.size(); ++i) {
    node.first_disc.push_back(static_cast<std::uint32_t>(cloud->size()));
    append_discs(*node.decoded, i, 1, header_.cube, *cloud);
  }
  node.first_disc.push_back(static_cast<std::uint32_t>(cloud->size()));
  if (node.box.empty())
    for (const glm::vec3& p : cloud->positions) node.box.add(p);
  cached_discs_ += cloud->size();
  node.used = cuts_;
  node.cloud = std::move(cloud);
  return true;
}

std::vector<Piece> LodStream::cut(const LodView& view) {
  ++cuts_;
  std::vector<bool> chosen(nodes_.size());
  std::vector<std::uint32_t> order;
  struct Candidate {
    float error;  // pixels
    std::uint32_t node;
    bool operator<(const Candidate& other) const {
      return error != other.error ? error < other.error : node > other.node;
    }
  };
  std::priority_queue<Candidate> candidates;
  std::size_t discs = 0;
  const auto choose = [&](std::uint32_t index) {
    Node& node = nodes_[index];
    if (!decode(index)) return;
    chosen[index] = true;
    order.push_back(index);
    node.used = cuts_;
    discs += node.voxels - (node.parent == kNoParent ? 0 : node.cluster.count);
    const float edge = header_.cube.edge / static_cast<float>(1 << node.decoded->level());
    for (const std::uint32_t child : node.children) {
      if (nodes_[child].broken || outside(nodes_[child].box, view)) continue;
      const float distance = distance_to(nodes_[child].box, view.eye);
      candidates.push({edge * view.pixels / std::max(distance, edge), child});
    }
  };
  choose(0);
  while (!candidates.empty() && candidates.top().error > view.error_pixels) {
    const std::uint32_t next = candidates.top().node;
    candidates.pop();
    if (view.budget != 0 && discs + nodes_[next].voxels > view.budget + nodes_[next].cluster.count) break;
    choose(next);
  }
  std::vector<Piece> pieces;
  for (const std::uint32_t index : order)
    if (!outside(nodes_[index].box, view)) pieces_of(index, chosen, pieces);
  if (cached_discs_ > cache_discs_) forget_unused();
  return pieces;
}

Cloud LodStream::whole() {
  Cloud all;
  all.description = header_.description;
  all.color = header_.color;
  LodView view;
  view.error_pixels = 0;
  for (const Piece& piece : cut(view)) {
    const auto append = [&piece](const auto& from, auto& to) {
      const auto first = from.begin() + static_cast<std::ptrdiff_t>(piece.first);
      to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(piece.count));
    };
    const Cloud& c = *piece.cloud;
    if (!c.colors.empty()) all.colors.resize(all.size(), all.color);
    append(c.positions, all.positions);
    append(c.normals, all.normals);
    append(c.weights, all.weights);
    append(c.cells, all.cells);
    if (!c.colors.empty())
      append(c.colors, all.colors);
    else if (!all.colors.empty())
      all.colors.resize(all.size(), all.color);
  }
  return all;
}

// The voxels of a cluster that no chosen child takes the place of.
void LodStream::pieces_of(std::uint32_t index, const std::vector<bool>& chosen, std::vector<Piece>& out) const {
  const Node& node = nodes_[index];
  std::vector<std::pair<std::uint32_t, std::uint32_t>> taken;
  for (const std::uint32_t child : node.children)
    if (chosen[child])
      taken.emplace_back(nodes_[child].cluster.first, nodes_[child].cluster.first + nodes_[child].cluster.count);
  std::sort(taken.begin(), taken.end());
  std::uint32_t next = 0;
  const auto end = static_cast<std::uint32_t>(node.first_disc.size() - 1);
  taken.emplace_back(end, end);
  for (const auto& [first, last] : taken) {
    if (next < std::min(first, end)) {
      const std::uint32_t from = node.first_disc[next], to = node.first_disc[std::min(first, end)];
      out.push_back({node.cloud, from, to - from});
    }
    next = std::max(next, last);
  }
}

void LodStream::forget_unused() {
  std::vector<std::uint32_t> old;
  for (std::uint32_t i = 0; i < nodes_.size(); ++i)
    if (nodes_[i].cloud && nodes_[i].used != cuts_) old.push_back(i);
  // Those that were not needed for longest go first; children before their parents.
  std::sort(old.begin(), old.end(), [&](std::uint32_t a, std::uint32_t b) {
    return nodes_[a].used != nodes_[b].used ? nodes_[a].used < nodes_[b].used : a > b;
  });
  for (const std::uint32_t i : old) {
    if (cached_discs_ <= cache_discs_) break;
    cached_discs_ -= nodes_[i].cloud->size();
    nodes_[i].cloud.reset();
    nodes_[i].decoded.reset();
    nodes_[i].first_disc = {};
  }
}

}  // namespace gs::qnv
