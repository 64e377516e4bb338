#pragma once

#include "qnv/base/cloud.h"

#include <glm/vec3.hpp>

#include <span>

namespace gs::app {

/// Sets the positions of `cloud`, which must have none, from source coordinates. Uses a local origin if they are far
/// from 0 (qnv::local_origin). Sets origin and box. Runs on any thread.
inline void set_places(qnv::Cloud& cloud, std::span<const glm::dvec3> places) {
  WideBox all;
  for (const glm::dvec3& place : places) all.add(place);
  qnv::Description& description = cloud.description;
  description.origin = qnv::local_origin(all);
  cloud.positions.reserve(places.size());
  for (const glm::dvec3& place : places) {
    cloud.positions.emplace_back(place - description.origin);
    description.box.add(cloud.positions.back());
  }
}

}  // namespace gs::app
