#include "qnv/codecs/displaced/decode/surface_stages.h"

#include "base/finite.h"
#include "qnv/codecs/displaced/subdivision.h"
#include "qnv/mesh/triangle_weights.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace gs::qnv {
namespace {

// Limit of the bytes of clusters that wait for a base mesh, which may never be received. The second constant is the
// overhead of each cluster.
constexpr std::size_t kMaxWaitingStageBytes = std::size_t{16} << 20, kWaitingCost = 128;

// Limits on the vertices of the drawn level: a number per received byte, plus a constant.
constexpr std::size_t kMaxVerticesAByte = 1024, kVerticesBesides = 65536;

// Returns the level to draw: the next finer level after the received levels, because it looks smooth without further
// data.
int shown_level(const displaced::Surface& surface) {
  int level = std::min(surface.header().depth, surface.finest() + 1);
  const std::size_t most = kVerticesBesides + kMaxVerticesAByte * surface.cluster_bytes();
  while (level > 0 && surface.slots().vertices_at(level) > most) --level;
  return level;
}

bool has_enough(const displaced::Surface& surface) {
  return surface.clusters() >= static_cast<std::size_t>(surface.header().clusters);
}

std::size_t most_slots(const displaced::Surface& surface) {
  return surface.slots().vertices_at(surface.header().depth);
}

/// Returns one flag per vertex slot: true if a patch uses the slot. Ignores the patches that `without` marks.
std::vector<bool> used_slots(const displaced::Surface& surface, int level, const std::vector<bool>& without) {
  std::vector<bool> used(surface.slots().vertices_at(level), false);
  std::vector<std::uint32_t> grid;
  for (std::uint32_t p = 0; p < surface.slots().size(); ++p) {
    if (without[p]) continue;
    surface.slots().grid(p, level, grid);
    for (const std::uint32_t slot : grid) used[slot] = true;
  }
  return used;
}

std::size_t slots_shown(const displaced::Surface& surface) { return surface.slots().vertices_at(shown_level(surface)); }

}  // namespace

void SurfaceStages::begin(std::span<const std::byte> base, const Box& box, std::size_t most_vectors) {
  box_ = box;
  most_vectors_ = most_vectors;
  if (auto first = displaced::decode_stage(base))
    add_stage(0, std::move(*first));
  else
    ++count_.refused;
}

void SurfaceStages::add_stage(int number, displaced::StageHeader stage) {
  displaced::Surface surface(std::move(stage));
  while (!fits(surface)) {
    count_.full = true;
    if (surface.header().depth == 0) return;
    surface.limit_depth(surface.header().depth - 1);
  }
  stages_.emplace(number, std::move(surface));
  ++count_.taken;
  drop_stages();
  recount();
  std::vector<std::vector<std::byte>> ready;
  const auto [first, last] = waiting_.equal_range(number);
  for (auto i = first; i != last; ++i) {
    waiting_bytes_ -= i->second.size() + kWaitingCost;
    ready.push_back(std::move(i->second));
  }
  waiting_.erase(first, last);
  for (const auto& payload : ready) add(payload);
}

// Drawn stages may have at most most_vectors_ vertices together. Waiting stages may have the same number again.
bool SurfaceStages::fits(const displaced::Surface& surface) const {
  std::size_t beside = 0, largest = 0, all = most_slots(surface);
  (surface.header().beside ? beside : largest) = all;
  for (const auto& [number, other] : stages_) {
    const std::size_t slots = most_slots(other);
    all += slots;
    if (other.header().beside)
      beside += slots;
    else
      largest = std::max(largest, slots);
  }
  return beside + largest <= most_vectors_ && all <= 2 * most_vectors_;
}

void SurfaceStages::drop_stages() {
  int last = 0;
  for (const auto& [number, surface] : stages_)
    if (!surface.header().beside && has_enough(surface)) last = number;
  std::erase_if(stages_, [&](const auto& of) {
    const bool gone = of.first < last && !of.second.header().beside;
    if (gone) gone_ |= 1u << of.first;
    return gone;
  });
}

void SurfaceStages::add(std::span<const std::byte> payload) {
  const auto cluster = displaced::decode_cluster_header(payload);
  if (!cluster) {
    ++count_.refused;
    return;
  }
  if ((gone_ >> cluster->stage & 1) != 0) return;
  if (cluster->kind == displaced::ClusterHeader::Kind::base) {
    // An encoder may send a base several times, so that losses do not remove all copies.
    if (stages_.contains(cluster->stage)) return;
    auto stage = displaced::decode_stage(payload.subspan(cluster->bytes));
    if (stage)
      add_stage(cluster->stage, std::move(*stage));
    else
      ++count_.refused;
    return;
  }
  const auto found = stages_.find(cluster->stage);
  if (found == stages_.end()) {
    if (waiting_bytes_ + payload.size() + kWaitingCost > kMaxWaitingStageBytes) {
      ++count_.refused;
      return;
    }
    waiting_bytes_ += payload.size() + kWaitingCost;
    waiting_.emplace(cluster->stage, std::vector<std::byte>(payload.begin(), payload.end()));
    return;
  }
  if (cluster->level > found->second.header().depth && count_.full) return;
  if (!found->second.add(*cluster, payload)) ++count_.refused;
  // Marks the change even if add() failed: a truncated cluster may have contributed numbers.
  if (const auto evaluator = evaluators_.find(cluster->stage); evaluator != evaluators_.end()) {
    if (cluster->kind == displaced::ClusterHeader::Kind::color)
      evaluator->second.colors_changed();
    else
      evaluator->second.changed(*cluster, found->second.patches().size());
  }
  ++count_.taken;
  drop_stages();
  recount();
}

const displaced::Surface* SurfaceStages::shown() const {
  for (auto i = stages_.rbegin(); i != stages_.rend(); ++i)
    if (!i->second.header().beside && has_enough(i->second)) return &i->second;
  return stages_.empty() ? nullptr : &stages_.begin()->second;
}

std::vector<std::pair<int, const displaced::Surface*>> SurfaceStages::all_shown() const {
  std::vector<std::pair<int, const displaced::Surface*>> all;
  const displaced::Surface* main = shown();
  for (const auto& [number, surface] : stages_)
    if (&surface == main) all.emplace_back(number, &surface);
  for (const auto& [number, surface] : stages_)
    if (surface.header().beside && &surface != main) all.emplace_back(number, &surface);
  return all;
}

void SurfaceStages::recount() {
  vectors_ = 0;
  for (const auto& [number, surface] : all_shown()) vectors_ += slots_shown(*surface);
}

void SurfaceStages::append(IndexedMesh& mesh, bool colored, const std::vector<bool>& without) const {
  bool main = true;
  for (const auto& [number, surface] : all_shown()) {
    append(*surface, mesh, colored, main ? without : std::vector<bool>());
    main = false;
  }
}

std::size_t SurfaceStages::vectors(const std::vector<bool>& without) const {
  const Shown stage = main();
  if (!stage.surface || without.empty()) return vectors_;
  const std::vector<bool> used = used_slots(*stage.surface, stage.level, without);
  return vectors_ - static_cast<std::size_t>(std::ranges::count(used, false));
}

SurfaceStages::Shown SurfaceStages::main() const {
  const auto all = all_shown();
  if (all.empty()) return {};
  const auto& [number, surface] = all.front();
  return {number, surface, shown_level(*surface)};
}

SurfacePatches SurfaceStages::patches(GeometryBase base) {
  std::erase_if(evaluators_, [&](const auto& each) { return !stages_.contains(each.first); });
  SurfacePatches patches{std::move(base), {}};
  for (const auto& [number, surface] : all_shown())
    patches.parts.push_back(evaluators_[number].state(*surface, shown_level(*surface), box_));
  return patches;
}

void SurfaceStages::append(const displaced::Surface& surface, IndexedMesh& mesh, bool colored,
                           const std::vector<bool>& without) const {
  const int level = shown_level(surface);
  const std::vector<glm::vec3> places = surface.positions(level);
  const std::vector<Rgb8> colors = surface.vertex_colors(level);
  const std::vector<glm::vec3> normals = displaced::slot_normals(surface.patches(), surface.slots(), level, places);
  const std::vector<std::uint32_t> vertex_of = surface.vertices_of_slots(level);
  const auto start = static_cast<std::uint32_t>(mesh.positions.size());
  // Omits slots that no remaining patch uses.
  std::vector<std::uint32_t> numbers;  // new index of each slot
  std::uint32_t count = start;
  std::vector<bool> used;
  if (!without.empty()) used = used_slots(surface, level, without);
  numbers.reserve(vertex_of.size());
  for (std::size_t slot = 0; slot < vertex_of.size(); ++slot)
    numbers.push_back(used.empty() || used[slot] ? count++ : displaced::kNone);
  mesh.positions.reserve(count);
  mesh.normals.reserve(count);
  if (colored) mesh.colors.reserve(count);
  const displaced::Frame frame(box_);
  for (std::size_t slot = 0; slot < vertex_of.size(); ++slot) {
    if (numbers[slot] == displaced::kNone) continue;
    const std::uint32_t v = vertex_of[slot];
    const glm::vec3 p = frame.outside(places[v]), n = normals[slot];
    mesh.positions.push_back(finite(p) ? p : frame.lower);
    mesh.normals.push_back(n == glm::vec3(0) ? glm::vec3(0, 0, 1) : n);
    if (colored) mesh.colors.push_back(colors.empty() ? mesh.color : colors[v]);
  }
  const std::size_t first = mesh.triangles.size();
  const std::vector<std::uint32_t> triangles = surface.triangles(level);
  const std::size_t corners = std::size_t{3} << 2 * level;  // number of corners per patch
  mesh.triangles.reserve(first + triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (without.empty() || !without[i / corners]) mesh.triangles.push_back(numbers[triangles[i]]);
  weigh_by_triangles(mesh, start, first);
}

}  // namespace gs::qnv
