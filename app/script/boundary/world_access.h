#pragma once

#include "app/script/boundary/node_ref.h"
#include "base/diagnostic.h"
#include "base/noncopyable.h"
#include "vrml/scene/node_type.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

// Questions and notices of programs to their world. Programs may run in another process and may be hostile, so the
// world checks each of them (docs/security.md).
namespace gs::app::script {

/// Kind of a question. The comment names the members of Question and Answer that it uses; all use Answer::good.
enum class Ask : std::uint8_t {
  describe,         // node -> its type; `flag` if its text is the one of the program
  may_read,         // node -> good if the program may read it
  read,             // node, place -> value
  name,             // node -> text: DEF name
  print_nodes,      // node.scene, value: MFNode -> text
  create_nodes,     // text -> value: MFNode, node.scene, number of nodes as item; else text: the reason
  create_from_url,  // node, text: eventIn, value: MFString
  load_url,         // value, second: MFString
  describe_world,   // text: description for the user
  set_viewpoint,    // text: description or name of a Viewpoint
  replace_world,    // value: MFNode of the program's scene
  change_route,     // node, text: eventOut, other, more: eventIn, flag: add, place: RouteEnds -> text: the reason
  browser,          // -> browser
  is_pressed,       // place: key code of Windows -> good
  set_setting,      // place: index in BrowserFacts::settings, flag
  set_event_mask,   // place: bits
  choose_mode,      // text
  move_viewer,      // value, second: SFVec3f and SFRotation, or SFBool for none
  bound_viewpoint,  // -> node
  cast_ray,         // value, second: SFVec3f; node: below, or none -> items: 3 + 3 + 2 numbers, then nodes
  navigation,       // text: field -> node, place of the field, value; the default value without a node
  make_navigation,  // -> node: the NavigationInfo that programs change, made if needed; flag: it must be bound
  imported_node,    // text: name -> node
  // Questions of X3D. `node` selects the text that contains it; no node means the text of the program.
  x3d_fields,             // node -> items: name, access type and type of each field
  x3d_types,              // node -> text: names of its types
  x3d_named,              // node, text: name -> node
  x3d_roots,              // node -> node.scene, value: MFNode
  x3d_set_roots,          // value: MFNode
  x3d_routes,             // node -> items: source, eventOut, target, eventIn of each ROUTE
  x3d_prototypes,         // node, flag: EXTERNPROTO -> items: names
  x3d_prototype_fields,   // node, text: name -> items, as for x3d_fields
  x3d_prototype_urls,     // node, text: name -> value: MFString
  x3d_create_instance,    // node, text: name -> node, number of nodes as item
  x3d_stated_components,  // node -> items: name and level of each
  x3d_metas,              // node -> items: name and content of each
  x3d_exported,           // node, text: name -> node
  x3d_context,            // node -> items: key, url, version, 1 for a PROTO instance, profile
};
inline constexpr int kAskCount = static_cast<int>(Ask::x3d_context) + 1;

/// Ends of a ROUTE that are the Browser object instead of a node, as bits of Question::place.
enum RouteEnds : std::uint32_t { kFromBrowser = 1, kToBrowser = 2 };

struct Question {
  Ask ask = Ask::describe;
  NodeRef node{}, other{};
  std::uint32_t place = 0;
  bool flag = false;
  std::string text{}, more{};
  vrml::FieldValue value{}, second{};
};

/// Facts about the browser and the viewer (VRML97 4.12.10, and other browsers).
struct BrowserFacts {
  double speed = 0, frame_rate = 0, start_time = 0;
  std::array<double, 3> position{};
  std::array<double, 4> orientation{};
  double width = 0, height = 0;                 // pixels of the viewport; 0 before there is one
  bool settings[4] = {true, true, true, true};  // collision, gravity, sound, moves to Viewpoints
  std::int32_t event_mask = 0;
  std::string world_url, base_url, mode;
};

using AnswerItem = std::variant<double, std::string, NodeRef>;

struct Answer {
  bool good = false, flag = false;
  NodeRef node;
  std::uint32_t place = 0;
  std::string text;
  vrml::FieldValue value;
  std::vector<AnswerItem> items;
  std::shared_ptr<const vrml::NodeType> type;
  std::shared_ptr<const BrowserFacts> browser;
};

/// Statement of the running program that needs no answer.
struct Notice {
  enum class Kind : std::uint8_t {
    hold,           // node: an object of the program refers to it
    release,        // node
    print,          // text
    report,         // text, severity, at: a message about the program
    direct_output,  // the program has written to another node
    own_value,      // place, value: field or eventOut of the program's Script
    send_own,       // place: send the value of an eventOut
    post,           // node, place, value: event for a node
  };
  Kind kind = Kind::hold;
  NodeRef node{};
  std::uint32_t place = 0;
  Severity severity = Severity::note;
  std::string text{};
  vrml::FieldValue value{};
  std::optional<Diagnostic> at{};
};
inline constexpr int kNoticeCount = static_cast<int>(Notice::Kind::post) + 1;

/// Interface of a world to its programs. Each call acts for the program that is running.
class WorldAccess : NonCopyable {
 public:
  virtual ~WorldAccess() = default;
  [[nodiscard]] virtual Answer ask(const Question& question) = 0;
  virtual void tell(const Notice& notice) = 0;
};

}  // namespace gs::app::script
