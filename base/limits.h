#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace gs {

/// Limited resources of a world; the rows of kResources define the amounts.
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

// Row of the table of limits.
struct ResourceRow {
  Resource resource;
  std::string_view name;  // name of the limit in messages
  unsigned share;  // share of Limits::memory, in 32nds
  std::size_t cost;       // bytes per unit; 1 means that the unit is a byte
  bool held;  // stays in memory as long as the world; counts towards kHeldShare
};

/// Table of the limits of one world. The shares add up to more than the memory, because no world is large in every way.
/// kHeldShare bounds the sum of all held resources. Costs include the copies made for drawing, even in GPU memory.
inline constexpr std::array<ResourceRow, 10> kResources = {{
    {Resource::unpacked, "unpacked data", 32, 1, false},  // output of gzip, even if it is discarded
    {Resource::files, "files in memory", 16, 1, true},  // files that are read or unpacked as a whole
    {Resource::nodes, "nodes and numbers", 16, 1, true},       // nodes, names, lists
    {Resource::instances, "PROTO instances", 8, 1, false},  // subset of nodes: created by PROTO instances
    {Resource::pixels, "pixels of textures", 12, 1, true},  // decoded images
    {Resource::meshes, "meshes", 16, 1, true},                 // geometries of nodes
    {Resource::volumes, "voxels", 16, 1, true},                // unpacked volumes
    {Resource::vectors, "vectors", 16, 1, true},  // stream records, splats, points, gradients
    {Resource::items, "shapes in a picture", 4, 1024, false},  // shapes, counted again for each USE
    {Resource::triangles, "triangles in a picture", 32, 32, false},
}};
/// Share of Limits::memory for all held resources, in 32nds. The program and images take the rest.
inline constexpr unsigned kHeldShare = 24;

/// Limits of one world and of each of its files. Only hostile worlds reach them; real worlds stay far below. All are
/// above the minima of VRML97 Table 7-1. Exceeding a limit gives a diagnostic, never a failure.
struct Limits {
  std::size_t memory = std::size_t{2} << 30;  // bytes, for all resources in kResources (`--memory`)

  std::size_t nesting = 2000;  // nodes, lists and PROTO bodies nested in each other
  std::size_t nodes = 50'000'000;                     // nodes per scene
  std::size_t expanded_nodes = 5'000'000;  // subset of `nodes`: copies made for PROTO instances
  std::size_t image_pixels = std::size_t{1} << 28;    // per image or SFImage, at its size in the file
  std::size_t texture_pixels = std::size_t{1} << 24;  // per image in memory; larger ones are scaled down
  std::size_t string_bytes = std::size_t{256} << 20;  // per SFString or name
  std::size_t unpack_ratio = 250;  // unpacked bytes per packed byte, after the first unpack_free bytes
  std::size_t unpack_free = std::size_t{64} << 20;
  std::size_t visits = 4'000'000;  // node visits while one picture is drawn
  std::size_t files = 20'000;                        // files of all kinds that a world refers to
  std::size_t inline_depth = 32;                     // nested Inlines and EXTERNPROTOs
  double script_seconds = 2;  // seconds per call of a Script's program
  std::size_t script_heap = std::size_t{256} << 20;  // bytes for the programs of all Scripts
};

}  // namespace gs
