#include "qnv/codecs/voxels/voxels_layout.h"

#include <bit>

namespace gs::qnv {
namespace {

std::uint32_t parameter_at(std::span<const std::byte> bytes, std::size_t i) {
  return std::to_integer<std::uint32_t>(bytes[i]);
}

}  // namespace

void VolumeVoxels::resize(std::size_t size) {
  x.resize(size);
  y.resize(size);
  z.resize(size);
  u.resize(size);
  v.resize(size);
  value.resize(size);
  magnitude.resize(size);
  activity.resize(size);
}

const OccupancyOdds& occupancy_odds() {
  // Coefficients of a logistic regression over the volumes of docs/benchmarks.md. The rounded values are part of the
  // format.
  static constexpr OccupancyOdds kOdds{{
      {{{{{-12, -15}, {0, 14}}}, {{{-15, -42}, {-8, -22}}}, {{{-4, -9}, {32, 38}}}}},
      {{{{{-7, -16}, {8, 13}}}, {{{-4, -35}, {5, -3}}}, {{{-13, -12}, {26, 22}}}}},
      {{{{{3, -14}, {18, 8}}}, {{{2, -21}, {17, 2}}}, {{{-3, -15}, {17, 11}}}}},
  }};
  return kOdds;
}

const std::array<std::uint16_t, 65>& logistic_table() {
  static constexpr std::array<std::uint16_t, 65> kLogistic{
      2048, 2176, 2303, 2428, 2550, 2668, 2782, 2891, 2994, 3092, 3184, 3269, 3349, 3422, 3490, 3551, 3608,
      3659, 3705, 3747, 3785, 3819, 3850, 3877, 3902, 3924, 3943, 3960, 3976, 3990, 4002, 4013, 4022, 4031,
      4038, 4045, 4051, 4056, 4061, 4065, 4069, 4072, 4075, 4077, 4079, 4081, 4083, 4085, 4086, 4087, 4088,
      4089, 4090, 4091, 4091, 4092, 4092, 4093, 4093, 4093, 4094, 4094, 4094, 4094, 4095};
  return kLogistic;
}

VolumeVoxels root_volume_voxel() {
  VolumeVoxels root;
  root.resize(1);
  root.value[0] = 128;
  root.magnitude[0] = kMagnitudeOne;
  root.activity[0] = 15;
  root.neighbours.resize(1);
  root.neighbours[0].fill(kNoNeighbour);
  return root;
}

// Across an inner face, the neighbour of a child is a sibling. Across an outer face, the neighbour is a child of the
// parent's neighbour.
void link_neighbours(const VolumeVoxels& from, std::size_t first, std::span<const std::uint8_t> masks,
                     std::span<const std::uint32_t> first_child, VolumeVoxels& children) {
  children.neighbours.resize(first_child.back());
  std::size_t next = 0;
  const auto child_of = [&](std::size_t parent, unsigned c) -> std::uint16_t {
    const unsigned mask = masks[parent];
    if ((mask >> c & 1) == 0) return kNoNeighbour;
    return static_cast<std::uint16_t>(first_child[parent] +
                                      static_cast<unsigned>(std::popcount(mask & ((1u << c) - 1))));
  };
  for (std::size_t i = 0; i < masks.size(); ++i) {
    const std::array<std::uint16_t, 6>& around = from.neighbours[first + i];
    for (unsigned mask = masks[i]; mask != 0; mask &= mask - 1) {
      const auto c = static_cast<unsigned>(std::countr_zero(mask));
      std::array<std::uint16_t, 6>& links = children.neighbours[next++];
      for (unsigned a = 0; a < 3; ++a)
        for (unsigned side = 0; side < 2; ++side) {
          const unsigned other = c ^ (1u << a);
          if ((c >> a & 1) != side) {
            links[2 * a + side] = child_of(i, other);
            continue;
          }
          const std::size_t n = around[2 * a + side];
          const bool divided = n != kNoNeighbour && n >= first && n - first < masks.size();
          links[2 * a + side] = divided ? child_of(n - first, other) : kNoNeighbour;
        }
    }
  }
}

std::variant<ClusterHeader, PackedError> read_volume_cluster_header(std::span<const std::byte> payload) {
  auto read = read_cluster_place(payload, kVolumeClusterHeaderSize);
  if (std::holds_alternative<PackedError>(read)) return read;
  const auto out_of = [&](std::size_t i, std::uint32_t most) {
    return parameter_at(payload, i) < 1 || parameter_at(payload, i) > most;
  };
  if (out_of(15, 255) || out_of(16, kOctahedral / kDirectionUnit) || out_of(17, kMaxMagnitude))
    return PackedError{"a cluster with invalid steps of values, directions or magnitudes"};
  return read;
}

VolumeParameters read_volume_parameters(std::span<const std::byte> header) {
  VolumeParameters p;
  p.occupancy = static_cast<std::uint8_t>(parameter_at(header, 14) & 7);
  p.bias = static_cast<std::uint8_t>(parameter_at(header, 14) >> 3);
  p.value_step = static_cast<std::uint8_t>(parameter_at(header, 15));
  p.direction_step = static_cast<std::uint8_t>(parameter_at(header, 16));
  p.magnitude_step = static_cast<std::uint8_t>(parameter_at(header, 17));
  p.slope = static_cast<std::uint8_t>(parameter_at(header, 18));
  p.turn = static_cast<std::uint8_t>(parameter_at(header, 19));
  const std::uint32_t models = parameter_at(header, 20) | parameter_at(header, 21) << 8 |
                               parameter_at(header, 22) << 16 | parameter_at(header, 23) << 24;
  const auto four = [&](std::size_t i) { return static_cast<std::uint8_t>(models >> (4 * i) & 15); };
  for (std::size_t i = 0; i < kResidualContexts; ++i) {
    p.direction[i] = four(i);
    p.value[i] = four(3 + i);
  }
  p.magnitude = four(6);
  p.trust = four(7);
  return p;
}

void write_volume_cluster_header(const ClusterHeader& header, const VolumeParameters& p, std::vector<std::byte>& out) {
  write_cluster_place(header, out);
  const auto put = [&](std::uint32_t value) { out.push_back(static_cast<std::byte>(value & 255)); };
  put(p.occupancy | static_cast<std::uint32_t>(p.bias) << 3);
  put(p.value_step);
  put(p.direction_step);
  put(p.magnitude_step);
  put(p.slope);
  put(p.turn);
  for (std::size_t i = 0; i < 2 * kResidualContexts + 2; i += 2) {
    const auto model = [&](std::size_t at) -> std::uint32_t {
      if (at < 3) return p.direction[at];
      if (at < 6) return p.value[at - 3];
      return at == 6 ? p.magnitude : p.trust;
    };
    put(model(i) | model(i + 1) << 4);
  }
}

}  // namespace gs::qnv
