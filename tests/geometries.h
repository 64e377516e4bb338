#pragma once

#include "qnv/base/geometry.h"

#include <catch2/catch.hpp>

#include <memory>
#include <utility>

namespace gs::qnv {

/// Returns the content of a geometry; fails the test if it has another form.
template <GeometryContent T>
T content_of(Geometry geometry) {
  REQUIRE(geometry.as<T>());
  return std::move(*geometry.as<T>());
}

/// Returns a copy of splats, a mesh or a volume as shared geometry.
template <class Content>
std::shared_ptr<const Geometry> shared_geometry(const std::shared_ptr<Content>& content) {
  return std::make_shared<const Geometry>(*content);
}

}  // namespace gs::qnv
