#include "vrml/behaviours/animation/interpolation.h"
#include "vrml/events/execution.h"
#include "vrml/scene/coordinates/geospatial.h"

#include <glm/common.hpp>

#include <cmath>

// GeoPositionInterpolator (ISO/IEC 19775-1 25.3.7): interpolates geospatial coordinates.
namespace gs::vrml {
namespace {

enum : int { kSetGeoFraction, kGeoKeys, kGeoKeyValues, kGeoValueChanged, kGeoPositionChanged };

bool set_geo_fraction(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != kSetGeoFraction) return true;
  const MFFloat& keys = execution.get<MFFloat>(node, kGeoKeys);
  const MFVec3d& values = execution.get<MFVec3d>(node, kGeoKeyValues);
  if (keys.empty() || values.size() < keys.size() || !execution.budget().spend(keys.size())) return false;
  const KeyPlace place = find_key(keys.span(), std::get<SFFloat>(value));
  const glm::dvec3 coordinates = glm::mix(values[place.first], values[place.second], static_cast<double>(place.part));
  if (!std::isfinite(coordinates.x + coordinates.y + coordinates.z)) return false;
  const EventMember& at = execution.nodes()[node];
  const SFVec3f position(GeoFrame::of(*at.scene, *at.node).position(coordinates));
  execution.send(node, kGeoValueChanged, SFVec3d(coordinates));
  execution.send(node, kGeoPositionChanged, position);
  return false;
}

}  // namespace

const Behaviour kGeoPositionInterpolatorBehaviour = {
    .events = {"set_fraction", "key", "keyValue", "geovalue_changed", "value_changed"},
    .on_event = set_geo_fraction,
};

}  // namespace gs::vrml
