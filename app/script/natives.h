#pragma once

#include "app/script/program.h"
#include "base/diagnostic.h"

#include <jsapi.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Functions of the objects that programs use: global objects, VRML97's types and the browser.
namespace gs::app::script {

// natives/globals.cpp
/// Creates a global object in the compartment of `beside`. If `beside` is null, creates a new compartment and zone.
JSObject* new_global(JSContext* context, Program* program, JS::HandleObject beside);
void forget_program(JSObject* global);
/// Makes the global object of a program, with its fields, eventOuts and eventIns. If `repeatable`, Math.random has a
/// fixed sequence. Returns false if memory is insufficient.
bool make_global(JSContext* context, Program& program, bool repeatable);
/// Reports a warning about the running program, unless it was reported before. `at` is its position, if known.
void warn(JSContext* context, std::string text, std::optional<Diagnostic> at = {});
/// Reports whether the library provides this name to every program of a language.
[[nodiscard]] bool is_library_name(std::string_view name, vrml::Language language);

// natives/values.cpp
/// Origin of a value that was read. When a part of the value is assigned, the whole value is written back there. If
/// `parent` is a global object or a node, `place` is the index of an interface. If it is a list, `place` is the index
/// of an element.
struct Source {
  JSObject* parent = nullptr;
  std::uint32_t place = 0;
};
/// Converts a field value. `scene` is the scene of its nodes.
bool to_value(JSContext* context, std::uint64_t scene, const vrml::FieldValue& field, Source source,
              JS::MutableHandleValue value);
/// Converts a value to a field value. Its nodes must belong to `scene`. Throws an exception and returns false on
/// failure.
bool to_field(JSContext* context, JS::HandleValue value, vrml::FieldType type, std::uint64_t scene,
              vrml::FieldValue& field);
/// Writes a value of which a part was assigned back to the object from which it was read; see Source.
bool write_back(JSContext* context, JS::HandleObject parent, std::uint32_t place, JS::HandleValue value);
bool set_own(JSContext* context, Program& program, std::uint32_t place, JS::HandleValue value);
bool text_of_value(JSContext* context, JS::HandleValue value, std::string& text);
/// Converts a value to text and keeps the first `most` characters.
bool cut_text_of_value(JSContext* context, JS::HandleValue value, std::size_t most, std::string& text);
bool make_string(JSContext* context, std::string_view text, JS::MutableHandleValue value);
bool fail(JSContext* context, const std::string& why);

// natives/tuples.cpp: SFColor, SFColorRGBA, SFRotation, and vectors
inline constexpr int kMaxComponents = 4;
bool define_tuples(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);
JSObject* make_tuple(JSContext* context, vrml::FieldType type, const double* components, Source source = {});
/// Returns the type and the components. Returns false if the object is no tuple.
[[nodiscard]] bool is_tuple(JSObject* object, vrml::FieldType& type, double* components);

// natives/lists.cpp: the MF types
bool define_lists(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);
JSObject* make_list(JSContext* context, ListBox box, Source source);
[[nodiscard]] ListBox* list_of(JSObject* object);
[[nodiscard]] vrml::FieldValue* list_value(ListBox& box);
bool set_element(JSContext* context, JS::HandleObject list, std::uint32_t index, JS::HandleValue value);
bool flush_list(JSContext* context, JS::HandleObject list);
/// Detaches a list from the Script's field or eventOut. The result is a separate, empty list of the same type.
void forget_program_of_list(ListBox& box);

// natives/nodes.cpp: SFNode
bool define_nodes(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);
JSObject* object_of_node(JSContext* context, const NodeRef& node);
[[nodiscard]] NodeBox* node_of(JSObject* object);
/// Converts a node to a value: its object, or null if there is no node.
bool node_to_value(JSContext* context, const NodeRef& node, JS::MutableHandleValue value);
/// Returns the node of a value. Returns no node if the value is none, or if the node left the world.
[[nodiscard]] NodeRef node_of_value(JS::HandleValue value);
/// Reports whether the running program may read a node.
[[nodiscard]] bool may_read(JSContext* context, NodeBox& node);
bool set_node_field(JSContext* context, JS::HandleObject node, std::uint32_t place, JS::HandleValue value);
/// Makes nodes from VRML text in the scene of the running program. Throws an exception and returns false on failure.
bool nodes_from_text(JSContext* context, std::string text, vrml::MFNode& nodes, std::uint64_t& scene);

// natives/images.cpp: SFImage
bool define_images(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);
JSObject* make_image(JSContext* context, const vrml::PixelImage& image, Source source);
[[nodiscard]] bool is_image(JSObject* object);
bool image_of(JSContext* context, JS::HandleObject object, vrml::PixelImage& image);
/// Writes an image back after an assignment to an element of its array.
bool image_array_changed(JSContext* context, JS::HandleObject image);

// natives/matrices.cpp
/// Makes a matrix of a matrix type, of 9 or 16 numbers.
JSObject* make_matrix(JSContext* context, vrml::FieldType type, const double* numbers, Source source = {});
/// Returns a copy without an origin. Returns null if the object is no matrix.
JSObject* copy_of_matrix(JSContext* context, JS::HandleObject object);
/// Returns the numbers of a matrix of `count` numbers. Returns false if the object is no such matrix.
[[nodiscard]] bool numbers_of_matrix(JSObject* object, int count, double* numbers);
bool define_matrices(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);

// browser/browser.cpp
bool define_browser(JSContext* context, JS::HandleObject library);
/// Reports whether the Browser object has a method with this name.
[[nodiscard]] bool is_browser_method(std::string_view name);

// x3d/x3d_library.cpp
/// Adds the objects of X3D to a library (ISO/IEC 19777-1).
bool define_x3d(JSContext* context, JS::HandleObject library);

}  // namespace gs::app::script
