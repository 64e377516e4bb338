#pragma once

/// Shaders that sort vectors by depth, and the data of items that they share with drawing shaders. Sorting shaders need
/// version 430.
namespace gs::render {

/// Location of vectors in buffer textures. `items` has ITEM_TEXELS texels for each item. Its texel PLACE has the number
/// of the first vector among all, and the place of its data, as halves of integers. Follows a shader with both names.
inline constexpr char kItemsShader[] = R"glsl(
uniform usamplerBuffer codes;
uniform samplerBuffer items;
uniform int item_count;

vec4 about(int item, int what) { return texelFetch(items, item * ITEM_TEXELS + what); }

// Joins two halves of an integer: a float has only 24 bits.
int whole(vec2 halves) { return int(halves.x) * 65536 + int(halves.y); }

// Location of a vector, from its number among all items: the item, the index in the item, and the item's first texel.
struct Place { int item, index, first; };
Place place_of(int number) {
  int low = 0, high = item_count - 1;
  while (low < high) {
    int middle = (low + high + 1) / 2;
    if (whole(about(middle, PLACE).xy) <= number) low = middle; else high = middle - 1;
  }
  vec4 place = about(low, PLACE);
  return Place(low, number - whole(place.xy), whole(place.zw));
}

// VRML97 Table 4.8, for a fog of four texels: rows of the matrix with the colour in the last column; then the type (0
// none, 1 LINEAR, 2 EXPONENTIAL) and the distance of the viewer in front of the camera.
vec3 fogged(int item, int fog, vec3 color, vec3 seen) {
  vec4 x = about(item, fog), y = about(item, fog + 1), z = about(item, fog + 2), type = about(item, fog + 3);
  if (type.x == 0.0) return color;
  seen.z += type.y;
  vec3 away = vec3(dot(x.xyz, seen), dot(y.xyz, seen), dot(z.xyz, seen));
  float ranges = min(sqrt(dot(away, away)), 1.0);
  float interpolant = type.x > 1.0 ? exp(-ranges / max(1.0 - ranges, 1e-6)) : 1.0 - ranges;
  return mix(vec3(x.w, y.w, z.w), color, interpolant);
}
)glsl";

/// Returns the number of a splat from its rank. The order has the farthest splat first; the ranks may begin with the
/// nearest.
inline constexpr char kRankShader[] = R"glsl(
uniform usamplerBuffer order;
uniform ivec2 ranks;  // texel of rank 0 of this draw call, and the step to the next
int number_at(int rank) { return int(texelFetch(order, ranks.x + ranks.y * rank).r); }
)glsl";

/// Common part of the sorting shaders. They sort by four bits at a time, lowest bits first. A group of 256 threads
/// processes a block of 4096 entries. Where their order matters, each thread takes 16 successive entries.
inline constexpr char kSortShader[] = R"glsl(
layout(local_size_x = 256) in;
uniform int total, shift, groups;
const uint BLOCK = 4096u, THREADS = 256u, EACH = 16u;
layout(std430, binding = 1) buffer Keys { uint keys[]; };
layout(std430, binding = 2) buffer Values { uint values[]; };
layout(std430, binding = 3) buffer SortedKeys { uint sorted_keys[]; };
layout(std430, binding = 4) buffer SortedValues { uint sorted_values[]; };
layout(std430, binding = 5) buffer Counts { uint counts[]; };  // by digit, then by block
)glsl";

/// Defines write_key(), which writes the keys and indexes of all vectors, last vector first, as in depth_sort.cpp. The
/// shader that follows has the main function.
inline constexpr char kSortKeysShader[] = R"glsl(
// Writes the k-th entry of this thread. Greater depths come first.
void write_key(uint k, float depth) {
  uint i = gl_WorkGroupID.x * BLOCK + k * THREADS + gl_LocalInvocationID.x;
  uint bits = floatBitsToUint(depth + 0.0);
  uint ascending = (bits >> 31) != 0u ? ~bits : bits | 0x80000000u;
  keys[i] = (bits & 0x7FFFFFFFu) > 0x7F800000u ? 0xFFFFFFFFu : ~ascending;
  values[i] = uint(total - 1) - i;
}
// Returns the number of the vector of the k-th entry, or -1 after the last.
int number_of(uint k) {
  uint i = gl_WorkGroupID.x * BLOCK + k * THREADS + gl_LocalInvocationID.x;
  return total - 1 - int(min(i, uint(total)));
}
)glsl";

inline constexpr char kSortCountShader[] = R"glsl(
shared uint bins[16];
void main() {
  uint thread = gl_LocalInvocationID.x;
  if (thread < 16u) bins[thread] = 0u;
  barrier();
  for (uint k = 0u; k < EACH; ++k) {
    uint i = gl_WorkGroupID.x * BLOCK + k * THREADS + thread;
    if (i < uint(total)) atomicAdd(bins[(keys[i] >> uint(shift)) & 15u], 1u);
  }
  barrier();
  if (thread < 16u) counts[thread * uint(groups) + gl_WorkGroupID.x] = bins[thread];
}
)glsl";

/// Computes the position of the first entry for each digit and block. Runs in one group.
inline constexpr char kSortScanShader[] = R"glsl(
shared uint sums[256];
void main() {
  uint thread = gl_LocalInvocationID.x, size = 16u * uint(groups), before = 0u;
  for (uint first = 0u; first < size; first += BLOCK) {
    uint sum = 0u;
    uint own = first + thread * EACH;
    for (uint k = 0u; k < EACH; ++k)
      if (own + k < size) sum += counts[own + k];
    sums[thread] = sum;
    barrier();
    for (uint step = 1u; step < THREADS; step *= 2u) {
      uint other = thread >= step ? sums[thread - step] : 0u;
      barrier();
      sums[thread] += other;
      barrier();
    }
    uint next = before + sums[thread] - sum;
    for (uint k = 0u; k < EACH; ++k)
      if (own + k < size) {
        uint count = counts[own + k];
        counts[own + k] = next;
        next += count;
      }
    before += sums[THREADS - 1u];
    barrier();
  }
}
)glsl";

inline constexpr char kSortScatterShader[] = R"glsl(
shared uint ranks[16 * 256];  // position in the block of the next entry, by digit and thread
shared uint parts[16 * 16];  // sums of 16 threads each
void main() {
  uint thread = gl_LocalInvocationID.x, first = gl_WorkGroupID.x * BLOCK + thread * EACH;
  for (uint digit = 0u; digit < 16u; ++digit) ranks[digit * THREADS + thread] = 0u;
  for (uint k = 0u; k < EACH; ++k)
    if (first + k < uint(total)) ranks[((keys[first + k] >> uint(shift)) & 15u) * THREADS + thread] += 1u;
  barrier();
  uint row = (thread / 16u) * THREADS + (thread & 15u) * 16u, sum = 0u;
  for (uint k = 0u; k < 16u; ++k) sum += ranks[row + k];
  parts[thread] = sum;
  barrier();
  uint next = 0u;
  for (uint k = thread & ~15u; k < thread; ++k) next += parts[k];
  for (uint k = 0u; k < 16u; ++k) {
    uint count = ranks[row + k];
    ranks[row + k] = next;
    next += count;
  }
  barrier();
  for (uint k = 0u; k < EACH; ++k) {
    if (first + k >= uint(total)) break;
    uint key = keys[first + k], digit = (key >> uint(shift)) & 15u;
    uint to = counts[digit * uint(groups) + gl_WorkGroupID.x] + ranks[digit * THREADS + thread]++;
    sorted_keys[to] = key;
    sorted_values[to] = values[first + k];
  }
}
)glsl";

}  // namespace gs::render
