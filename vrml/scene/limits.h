#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace gs::vrml {

/// What a world spends; the rows of kResources say how much there is of each.
enum class Resource : std::uint8_t {
  unpacked,
  files,
  nodes,
  instances,
  pixels,
  meshes,
  volumes,
  vectors,
  items,
  triangles
};

struct ResourceRow {
  Resource resource;
  std::string_view name;  // of the limit, for messages
  unsigned share;         // of Limits::memory, in 32nds
  std::size_t cost;       // bytes that one unit counts for; 1: the unit is a byte
  bool held;              // kept in memory while the world lives, and so a part of the sum of all such
};

/// The limits of one world. Shares add up to more than the whole, because no world is large in every way; what is held
/// is bounded together (kHeldShare), too. Costs count the copies that drawing makes, as if they all lay in memory.
inline constexpr std::array<ResourceRow, 10> kResources = {{
    {Resource::unpacked, "unpacked data", 32, 1, false},       // what gzip data become, also where they are not kept
    {Resource::files, "files in memory", 16, 1, true},         // what is read, or unpacked, as a whole
    {Resource::nodes, "nodes and numbers", 16, 1, true},       // nodes, names, lists
    {Resource::instances, "PROTO instances", 8, 1, false},     // of these: what instances make
    {Resource::pixels, "pixels of textures", 12, 1, true},     // decoded
    {Resource::meshes, "meshes", 16, 1, true},                 // geometries made of nodes
    {Resource::volumes, "voxels", 16, 1, true},                // unpacked volumes
    {Resource::vectors, "vectors", 16, 1, true},               // of streams, splats, points and gradients
    {Resource::items, "shapes in a picture", 4, 1024, false},  // with all that USE multiplies
    {Resource::triangles, "triangles in a picture", 32, 32, false},
}};
/// Of Limits::memory, in 32nds: all that is held at a time. The program itself and pictures take the rest.
inline constexpr unsigned kHeldShare = 24;

/// What one world may cost, and one file of it. VRML97 Table 7-1 gives minima; these are far above what any real world
/// holds and only stop hostile ones. Passing a limit gives a diagnostic, never a failure.
struct Limits {
  std::size_t memory = std::size_t{2} << 30;  // bytes, for all that kResources names (`--memory`)

  std::size_t nesting = 2000;                         // open nodes, lists and PROTO bodies inside each other
  std::size_t nodes = 50'000'000;                     // nodes of one scene
  std::size_t expanded_nodes = 5'000'000;             // of these, copies made for PROTO instances
  std::size_t image_pixels = std::size_t{1} << 28;    // of one picture or SFImage, as the file has it
  std::size_t texture_pixels = std::size_t{1} << 24;  // of one picture as it is kept; larger ones are made smaller
  std::size_t string_bytes = std::size_t{256} << 20;  // one SFString or name
  std::size_t unpack_ratio = 250;                     // bytes unpacked of one packed byte, behind the first unpack_free
  std::size_t unpack_free = std::size_t{64} << 20;
  std::size_t visits = 4'000'000;  // of nodes, for one picture
  std::size_t files = 20'000;      // that a world refers to, of all kinds
  std::size_t inline_depth = 32;   // Inlines and EXTERNPROTOs inside each other
  double script_seconds = 2;       // of one call of a program
  std::size_t script_heap = std::size_t{256} << 20;  // bytes of all programs
};

}  // namespace gs::vrml
