#pragma once

#include <cstddef>

namespace gs::vrml {

/// What one file may cost. VRML97 Table 7-1 gives minima; these are far above what any real world
/// holds and only stop hostile ones. Passing a limit gives a diagnostic, never a failure.
struct Limits {
  std::size_t nesting = 2000;               // open nodes, lists and PROTO bodies inside each other
  std::size_t nodes = 50'000'000;           // nodes of one scene
  std::size_t expanded_nodes = 5'000'000;   // of these, copies made for PROTO instances
  std::size_t image_pixels = 1u << 28;      // pixels of one SFImage
  std::size_t extrusion_points = 1u << 22;  // spine points times crossSection points of one Extrusion
  std::size_t string_bytes = 256u << 20;    // one SFString or name
};

}  // namespace gs::vrml
