#include "qnv/codecs/values/bricks/received/remainder_runs.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <variant>

namespace gs::qnv::values {

namespace {

/// Box of cubes, and their numbers.
struct CubeRange {
  CubeRange(const SampleBox& box, Extent extent) : all(cube_extent(extent)) {
    for (std::size_t a = 0; a < 3; ++a) {
      first[a] = box.first[a] / kCubeEdge;
      last[a] = (box.first[a] + box.size[a] - 1) / kCubeEdge;
    }
  }
  [[nodiscard]] std::uint64_t number(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (std::uint64_t{z} * all[1] + y) * all[0] + x;
  }
  Extent all, first{}, last{};
};

}  // namespace

bool RemainderRuns::note(const RunPlace& place) {
  const Extent extent = cube_extent(extent_);
  const std::uint64_t all = std::uint64_t{extent[0]} * extent[1] * extent[2];
  if (place.first >= all || place.count > all - place.first) return false;
  const auto at = std::ranges::lower_bound(places_, place.first, {}, &RunPlace::first);
  if (at != places_.end() && at->first == place.first) return at->offset == place.offset;
  if (place.count > 2 * all - cubes_ || places_.size() >= kMaxDirectoryEntries) return false;
  if (at != places_.end() && ++late_ > kMostLate) return false;
  cubes_ += place.count;
  places_.insert(at, place);
  return true;
}

void RemainderRuns::visit(const SampleBox& box, const std::function<void(const RunPlace&)>& visit) const {
  const CubeRange range(box, extent_);
  std::size_t next = 0;  // runs before it were visited
  for (std::uint32_t z = range.first[2]; z <= range.last[2]; ++z)
    for (std::uint32_t y = range.first[1]; y <= range.last[1]; ++y) {
      const std::uint64_t row = range.number(range.first[0], y, z), end = range.number(range.last[0], y, z);
      auto at = std::ranges::upper_bound(places_, row, {}, &RunPlace::first);
      // Runs do not overlap, so that only the last one before the row can reach it.
      if (at != places_.begin() && std::prev(at)->first + std::prev(at)->count > row) --at;
      at = std::max(at, places_.begin() + static_cast<std::ptrdiff_t>(next));
      for (; at != places_.end() && at->first <= end; ++at) visit(*at);
      next = static_cast<std::size_t>(at - places_.begin());
    }
}

std::optional<CubeRun> RemainderRuns::read(const RunPlace& place) const {
  std::optional<CubeRun> run;
  if (!source_) {
    if (const std::vector<std::byte>* const payload = kept_.find(place.offset)) run = parse_run(*payload);
  } else {
    thread_local std::vector<std::byte> buffer;
    const auto chunk = read_chunk(*source_, place.offset, place.bytes, buffer);
    const auto* const sound = std::get_if<SoundChunk>(&chunk);
    if (sound && sound->type == ChunkType::remainders) run = parse_run(sound->payload);
  }
  if (run && (run->first != place.first || run->count != place.count)) run.reset();
  return run;
}

void RemainderRuns::add(CubeFlags& cubes, std::span<std::uint32_t> numbers) const {
  const CubeRange range(cubes.box, extent_);
  const SampleBox& box = cubes.box;
  // Returns the place of a cube in the box, or nullopt.
  const auto place_in_box = [&](std::uint64_t cube) -> std::optional<Extent> {
    const std::array<std::uint64_t, 3> at{cube % range.all[0], cube / range.all[0] % range.all[1],
                                          cube / range.all[0] / range.all[1]};
    Extent place{};
    for (std::size_t a = 0; a < 3; ++a) {
      if (at[a] < range.first[a] || at[a] > range.last[a]) return std::nullopt;
      place[a] = static_cast<std::uint32_t>(at[a]) * kCubeEdge;
    }
    return place;
  };
  const std::uint64_t last = range.number(range.last[0], range.last[1], range.last[2]);
  visit(box, [&](const RunPlace& run) {
    std::uint64_t next = run.first;  // cubes from it on are not decoded
    const auto take = [&](std::uint64_t cube, std::span<const std::uint32_t, kCubeSize> steps) {
      next = cube + 1;
      const auto at = place_in_box(cube);
      if (!at || !cubes.is_set((*at)[0], (*at)[1], (*at)[2])) return;
      Extent size{};
      for (std::size_t a = 0; a < 3; ++a) size[a] = std::min(kCubeEdge, box.first[a] + box.size[a] - (*at)[a]);
      for (std::uint32_t z = 0; z < size[2]; ++z)
        for (std::uint32_t y = 0; y < size[1]; ++y)
          for (std::uint32_t x = 0; x < size[0]; ++x)
            numbers[(std::size_t{(*at)[2] + z - box.first[2]} * box.size[1] + ((*at)[1] + y - box.first[1])) *
                        box.size[0] +
                    ((*at)[0] + x - box.first[0])] += steps[x + kCubeEdge * (y + kCubeEdge * z)];
    };
    if (const auto known = read(run)) (void)decode_remainder_cubes(*known, extent_, last, take);
    for (; next < run.first + run.count && next <= last; ++next)
      if (const auto at = place_in_box(next)) cubes.at((*at)[0], (*at)[1], (*at)[2]) = 0;
  });
}

}  // namespace gs::qnv::values
