// The inner loops of the surface splatter. Included once for every set of vector instructions, inside a namespace of
// its own and with SPLAT_TARGET naming them; eight samples of a row go together.

using Float8 = float __attribute__((vector_size(32), aligned(4)));
using Int8 = std::int32_t __attribute__((vector_size(32)));

#define SPLAT_INLINE static __attribute__((always_inline)) inline

SPLAT_INLINE void put8(float* to, const Float8& v) { std::memcpy(to, &v, sizeof v); }
SPLAT_INLINE void get8(const float* from, Float8& v) { std::memcpy(&v, from, sizeof v); }

/// Calls body(row of the tile, x of the tile, rays) for the groups of eight samples that a disc may cover.
template <class Body>
SPLAT_INLINE void for_samples(const SplatDisc& disc, const SplatBounds& bounds, const SplatRays& rays, int left,
                              int bottom, Body body) {
  const int x1 = std::min(bounds.x1 - left, kTile - 1), y1 = std::min(bounds.y1 - bottom, kTile - 1);
  // Begins where the disc does, so that most discs are one group wide.
  const int x0 = std::min(std::max(bounds.x0 - left, 0), kTile - 8), y0 = std::max(bounds.y0 - bottom, 0);
  const Float8 step = {0, 1, 2, 3, 4, 5, 6, 7};
  for (int y = y0; y <= y1; ++y) {
    const auto sample_y = static_cast<float>(bottom + y);
    const glm::vec3 row = rays.origin + rays.up * sample_y;
    const float facing_row = disc.facing + disc.facing_y * sample_y;
    for (int first = x0; first <= x1; first += 8) {
      // The last group of a wide disc ends with the tile; samples that it has again are left as they are.
      const int x = std::min(first, kTile - 8);
      const Float8 sample_x = step + static_cast<float>(left + x);
      const Float8 facing = facing_row + disc.facing_x * sample_x;
      const Float8 rx = row.x + rays.right.x * sample_x, ry = row.y + rays.right.y * sample_x,
                   rz = row.z + rays.right.z * sample_x;
      body(static_cast<std::size_t>(y * kTile + x), first - x, facing, rx, ry, rz);
    }
  }
}

SPLAT_INLINE Float8 absolute(const Float8& v) { return v < 0.0f ? -v : v; }

template <bool cubes, bool sides>
SPLAT_INLINE void depth_pass(const SplatDisc& disc, const SplatRays& rays, int left, int bottom, SplatTile& tile) {
  for_samples(
      disc, disc.cover, rays, left, bottom,
      [&](std::size_t at, int, const Float8& facing, const Float8& rx, const Float8& ry, const Float8& rz)
          __attribute__((always_inline)) {
            const Float8 depth = disc.plane / facing;
            const Float8 dx = rx * depth - disc.clip.x, dy = ry * depth - disc.clip.y, dz = rz * depth - disc.clip.z;
            Int8 covered;
            if constexpr (cubes) {
              const Float8 ax = absolute(dx), ay = absolute(dy), az = absolute(dz);
              covered = (ax < disc.reach) & (ay < disc.reach) & (az < disc.reach);
            } else {
              covered = dx * dx + dy * dy + dz * dz < disc.reach;
            }
            Float8 nearest;
            get8(tile.depth.data() + at, nearest);
            covered &= (depth < nearest) & (depth > rays.near_plane);
            put8(tile.depth.data() + at, covered ? depth : nearest);
            if constexpr (sides) {
              Float8 side;
              get8(tile.side.data() + at, side);
              put8(tile.side.data() + at, covered ? Float8{} + disc.plane : side);
            }
          });
}

template <bool colored, bool sides, bool smooth>
SPLAT_INLINE void blend_pass(const SplatDisc& disc, const SplatRays& rays, int left, int bottom, SplatTile& tile) {
  const float quarter = disc.inverse_radius2 * 0.25f;
  const auto red = static_cast<float>(disc.color & 255), green = static_cast<float>(disc.color >> 8 & 255),
             blue = static_cast<float>(disc.color >> 16 & 255);
  const auto add = [&](std::array<float, kTile * kTile> & to, std::size_t at, const Float8& v)
      __attribute__((always_inline)) {
    Float8 old;
    get8(to.data() + at, old);
    put8(to.data() + at, old + v);
  };
  for_samples(
      disc, disc.bell, rays, left, bottom,
      [&](std::size_t at, int again, const Float8&, const Float8& rx, const Float8& ry, const Float8& rz)
          __attribute__((always_inline)) {
            Float8 nearest;
            get8(tile.depth.data() + at, nearest);
            const Float8 dx = rx * nearest - disc.place.x, dy = ry * nearest - disc.place.y,
                         dz = rz * nearest - disc.place.z;
            // (1 - rho^2 / 4)^4: nearly exp(-1.2 rho^2), and nothing beyond two radii.
            Float8 bell = 1.0f - (dx * dx + dy * dy + dz * dz) * quarter;
            // `again` of the first samples were counted in the group before.
            const Int8 lane = {0, 1, 2, 3, 4, 5, 6, 7};
            Int8 counts = (bell > 0.0f) & (lane >= again);
            if constexpr (sides) {
              Float8 side;
              get8(tile.side.data() + at, side);
              counts &= side * disc.plane > 0.0f;
            }
            bell = counts ? bell : Float8{};
            const Float8 square = bell * bell;
            const Float8 slope = square * bell * (-8 * quarter);
            bell = square * square;
            add(tile.weight, at, bell);
            add(tile.normal_x, at, bell * disc.normal.x);
            add(tile.normal_y, at, bell * disc.normal.y);
            add(tile.normal_z, at, bell * disc.normal.z);
            if constexpr (smooth) {
              const Float8 height = dx * disc.normal.x + dy * disc.normal.y + dz * disc.normal.z;
              const Float8 tilt = slope * height;
              add(tile.height, at, bell * height);
              add(tile.slope_x, at, slope * dx);
              add(tile.slope_y, at, slope * dy);
              add(tile.slope_z, at, slope * dz);
              add(tile.tilt_x, at, tilt * dx);
              add(tile.tilt_y, at, tilt * dy);
              add(tile.tilt_z, at, tilt * dz);
            }
            if constexpr (colored) {
              add(tile.red, at, bell * red);
              add(tile.green, at, bell * green);
              add(tile.blue, at, bell * blue);
            }
          });
}

template <bool cubes, bool sides>
SPLAT_INLINE void all_depths(const SplatDisc* discs, std::span<const std::uint32_t> chosen, const SplatRays& rays,
                             int left, int bottom, SplatTile& tile) {
  for (const std::uint32_t i : chosen) depth_pass<cubes, sides>(discs[i], rays, left, bottom, tile);
}

template <bool colored, bool sides, bool smooth>
SPLAT_INLINE void all_bells(const SplatDisc* discs, std::span<const std::uint32_t> chosen, const SplatRays& rays,
                            int left, int bottom, SplatTile& tile) {
  for (const std::uint32_t i : chosen) blend_pass<colored, sides, smooth>(discs[i], rays, left, bottom, tile);
}

SPLAT_TARGET static void tile(const SplatDisc* discs, std::span<const std::uint32_t> chosen, const SplatRays& rays,
                              int left, int bottom, const SplatKind& kind, SplatTile& tile) {
  tile.depth.fill(kFar);
  for (auto* channel : {&tile.weight, &tile.normal_x, &tile.normal_y, &tile.normal_z, &tile.side}) channel->fill(0);
  if (kind.colored)
    for (auto* channel : {&tile.red, &tile.green, &tile.blue}) channel->fill(0);
  if (kind.smooth)
    for (auto* channel :
         {&tile.slope_x, &tile.slope_y, &tile.slope_z, &tile.tilt_x, &tile.tilt_y, &tile.tilt_z, &tile.height})
      channel->fill(0);
  switch ((kind.cubes ? 2 : 0) | (kind.sides ? 1 : 0)) {
    case 0:
      all_depths<false, false>(discs, chosen, rays, left, bottom, tile);
      break;
    case 1:
      all_depths<false, true>(discs, chosen, rays, left, bottom, tile);
      break;
    case 2:
      all_depths<true, false>(discs, chosen, rays, left, bottom, tile);
      break;
    default:
      all_depths<true, true>(discs, chosen, rays, left, bottom, tile);
  }
  switch ((kind.colored ? 4 : 0) | (kind.sides ? 2 : 0) | (kind.smooth ? 1 : 0)) {
    case 0:
      all_bells<false, false, false>(discs, chosen, rays, left, bottom, tile);
      break;
    case 1:
      all_bells<false, false, true>(discs, chosen, rays, left, bottom, tile);
      break;
    case 2:
      all_bells<false, true, false>(discs, chosen, rays, left, bottom, tile);
      break;
    case 3:
      all_bells<false, true, true>(discs, chosen, rays, left, bottom, tile);
      break;
    case 4:
      all_bells<true, false, false>(discs, chosen, rays, left, bottom, tile);
      break;
    case 5:
      all_bells<true, false, true>(discs, chosen, rays, left, bottom, tile);
      break;
    case 6:
      all_bells<true, true, false>(discs, chosen, rays, left, bottom, tile);
      break;
    default:
      all_bells<true, true, true>(discs, chosen, rays, left, bottom, tile);
  }
}

#undef SPLAT_INLINE
