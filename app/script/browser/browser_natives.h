#pragma once

#include "app/script/natives.h"
#include "app/script/script_world.h"

#include <js/Conversions.h>

#include <cstdint>

// Methods and properties of the Browser object, by file. browser.cpp has their table.
namespace gs::app::script {

// routes.cpp
/// Adds or deletes a ROUTE (VRML97 4.12.10). The Browser object stands for the browser as a node.
bool add_route(JSContext* context, unsigned argc, JS::Value* vp);
bool delete_route(JSContext* context, unsigned argc, JS::Value* vp);

// viewer.cpp
bool get_viewpoint_position(JSContext* context, unsigned argc, JS::Value* vp);
bool set_viewpoint_position(JSContext* context, unsigned argc, JS::Value* vp);
bool get_viewpoint_orientation(JSContext* context, unsigned argc, JS::Value* vp);
bool set_viewpoint_orientation(JSContext* context, unsigned argc, JS::Value* vp);
/// Moves the viewer to a position and an orientation in world space, at once.
bool set_viewpoint_by_value(JSContext* context, unsigned argc, JS::Value* vp);
/// Writes the viewer's position and orientation into the given SFVec3f and SFRotation.
bool get_viewpoint_by_value(JSContext* context, unsigned argc, JS::Value* vp);
bool get_bound_viewpoint(JSContext* context, unsigned argc, JS::Value* vp);
bool get_window_width(JSContext* context, unsigned argc, JS::Value* vp);
bool get_window_height(JSContext* context, unsigned argc, JS::Value* vp);
bool get_window_aspect(JSContext* context, unsigned argc, JS::Value* vp);
bool get_window_size(JSContext* context, unsigned argc, JS::Value* vp);
bool get_event_mask(JSContext* context, unsigned argc, JS::Value* vp);
bool set_event_mask(JSContext* context, unsigned argc, JS::Value* vp);
bool is_key_pressed(JSContext* context, unsigned argc, JS::Value* vp);

// ray_hit.cpp
/// Returns the nearest Shape between two points: hitPoint, hitNormal, hitTexCoord and hitPath. Returns null if there is
/// none, or if the program may not read a node of the path.
bool compute_ray_hit(JSContext* context, unsigned argc, JS::Value* vp);

// navigation.cpp: properties of the bound NavigationInfo (6.29). If none is bound, a setter makes and binds one.
enum class Measure : std::uint8_t { distance, height, step, visibility, speed };
bool get_measure_of(JSContext* context, unsigned argc, JS::Value* vp, Measure measure);
bool set_measure_of(JSContext* context, unsigned argc, JS::Value* vp, Measure measure);
template <Measure kMeasure>
bool get_measure(JSContext* context, unsigned argc, JS::Value* vp) {
  return get_measure_of(context, argc, vp, kMeasure);
}
template <Measure kMeasure>
bool set_measure(JSContext* context, unsigned argc, JS::Value* vp) {
  return set_measure_of(context, argc, vp, kMeasure);
}
bool get_z_near(JSContext* context, unsigned argc, JS::Value* vp);
bool get_z_far(JSContext* context, unsigned argc, JS::Value* vp);
bool get_headlight(JSContext* context, unsigned argc, JS::Value* vp);
bool set_headlight(JSContext* context, unsigned argc, JS::Value* vp);
bool get_navigation_mode(JSContext* context, unsigned argc, JS::Value* vp);
bool set_navigation_mode(JSContext* context, unsigned argc, JS::Value* vp);
/// Index in BrowserFacts::settings.
enum Setting : std::uint32_t { kCollision, kGravity, kSound, kViewpointAnimation };
template <Setting kSetting>
bool get_setting(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().setBoolean(world_of(context).view().browser().settings[kSetting]);
  return true;
}
template <Setting kSetting>
bool set_setting(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  args.rval().setUndefined();
  (void)world_of(context).view().ask({Ask::set_setting, {}, {}, kSetting, JS::ToBoolean(args.get(0))});
  return true;
}

// others.cpp
bool get_start_time(JSContext* context, unsigned argc, JS::Value* vp);
bool get_world_base_url(JSContext* context, unsigned argc, JS::Value* vp);
bool get_base_url(JSContext* context, unsigned argc, JS::Value* vp);
/// Returns the value of an option that a program has set; otherwise an empty text.
bool get_option(JSContext* context, unsigned argc, JS::Value* vp);
/// Stores the value of an option. Returns false if the library holds too many.
bool set_option(JSContext* context, unsigned argc, JS::Value* vp);
bool get_script(JSContext* context, unsigned argc, JS::Value* vp);
/// Returns the node that the scene of the program has imported under a name (IMPORT of X3D). Returns null while its
/// Inline is not loaded, and for unknown names.
bool get_imported_node(JSContext* context, unsigned argc, JS::Value* vp);
// Answers to functions that only other browsers implement.
bool do_nothing(JSContext* context, unsigned argc, JS::Value* vp);
bool give_false(JSContext* context, unsigned argc, JS::Value* vp);
bool give_zero(JSContext* context, unsigned argc, JS::Value* vp);
bool give_empty(JSContext* context, unsigned argc, JS::Value* vp);

}  // namespace gs::app::script
