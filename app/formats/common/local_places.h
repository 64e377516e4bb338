#pragma once

#include "qnv/base/geometry.h"

#include <glm/vec3.hpp>

#include <span>

namespace gs::app {

/// Sets the positions of `splats`, which must have none, from source coordinates. Uses a local origin if they are far
/// from 0 (qnv::local_origin). Sets origin and box. Runs on any thread.
inline void set_places(qnv::Splats& splats, std::span<const glm::dvec3> places) {
  WideBox all;
  for (const glm::dvec3& place : places) all.add(place);
  qnv::Description& description = splats.description;
  description.origin = qnv::local_origin(all);
  splats.positions.reserve(places.size());
  for (const glm::dvec3& place : places) {
    splats.positions.emplace_back(place - description.origin);
    description.box.add(splats.positions.back());
  }
}

}  // namespace gs::app
