#pragma once

#include "app/script/engine.h"
#include "app/script/script_runner.h"

#include <jsapi.h>
#include <chrono>

#include <deque>
#include <memory>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

// The inside of ScriptRunner. Each Script has a global object of its own, so that names without `var` are its own, too;
// the objects of VRML97's types are made once a world, and shared by all of them.
namespace gs::app::script {

class World;

/// Properties that programs find in a list of them, and cannot delete.
constexpr unsigned kProperty = JSPROP_ENUMERATE | JSPROP_PERMANENT;

/// A Script and its program.
struct Program {
  World* world = nullptr;
  vrml::EventNode node = 0;
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId id;
  JS::PersistentRootedObject global;
  std::vector<jsid> names;                                         // by place in the type's interfaces
  std::vector<std::unique_ptr<JS::PersistentRootedObject>> lists;  // likewise: the object of an MF field or eventOut
  std::vector<bool> unsent;                                        // likewise: eventOuts that were assigned
  std::vector<std::uint32_t> to_send;
  bool runs = false, waits = false, off = false, has_processed = false, told_direct = false;
  int faults = 0;
  std::size_t next_url = 0;  // of the url list: what has not been tried
};

/// What outlives a world, since garbage may be collected later.
struct Link {
  vrml::Execution* execution = nullptr;                  // null: the world is gone
  std::unordered_map<std::uint64_t, JSObject*> objects;  // of nodes, by index and generation
};

/// A node that a program knows; it is held.
struct NodeBox {
  std::shared_ptr<Link> link;
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId id;
};

/// A value of an MF type: that of a Script's field or eventOut, or one that only the program has.
struct ListBox {
  std::shared_ptr<Link> link;
  Engine* engine = nullptr;
  Program* program = nullptr;  // whose field or eventOut it is; null: nobody's
  std::uint32_t place = 0;
  vrml::SceneGraph* scene = nullptr;  // of nodes
  vrml::FieldValue value;             // where it is nobody's
  std::vector<vrml::NodeId> held;
  std::size_t counted = 0;  // bytes
  bool changed = false;     // what it was read from is to get its value
};

class World final : public ScriptRunner {
 public:
  World(vrml::Execution& execution, Engine& engine, Settings settings);
  ~World() override;

  bool begin(vrml::EventNode script) override;
  bool deliver(vrml::EventNode script, std::uint32_t interface, const vrml::FieldValue& value, double time) override;
  void events_processed(vrml::EventNode script) override;
  void end(vrml::EventNode script) override;
  void forget(vrml::EventNode script) override;
  [[nodiscard]] bool waits(vrml::EventNode script) const override;
  [[nodiscard]] bool has_time() override;
  void begin_step() override;
  void set_browser(BrowserState state) override { browser_ = std::move(state); }
  void found(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
             const std::string& url) override;
  void provide(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
               const std::string& url) override;
  [[nodiscard]] Evaluation evaluate(const vrml::SceneGraph& scene, vrml::NodeId script,
                                    const std::string& line) override;
  [[nodiscard]] std::vector<ScriptMessage> take_messages() override { return std::exchange(messages_, {}); }
  void observe(std::function<void(const ScriptMessage&)> observer) override { observer_ = std::move(observer); }
  [[nodiscard]] std::vector<ScriptRequest> take_requests() override { return std::exchange(requests_, {}); }
  [[nodiscard]] bool is_late() const override { return late_; }

  // For what programs call.
  [[nodiscard]] vrml::Execution& execution() { return execution_; }
  [[nodiscard]] Engine& engine() { return engine_; }
  [[nodiscard]] const std::shared_ptr<Link>& link() const { return link_; }
  [[nodiscard]] const BrowserState& browser() const { return browser_; }
  [[nodiscard]] JSObject* prototype(vrml::FieldType type) const { return prototypes_[static_cast<int>(type)]; }
  [[nodiscard]] JSObject* matrix_prototype() const { return prototypes_[kMatrixPrototype]; }
  [[nodiscard]] JSObject* row_prototype() const { return prototypes_[kRowPrototype]; }
  /// Whose function was called by Execution.
  [[nodiscard]] Program& running() { return *running_; }
  [[nodiscard]] bool ends() const { return ends_; }
  [[nodiscard]] double random();
  [[nodiscard]] bool is_repeatable() const { return settings_.repeatable; }
  /// What Date tells in simulated time, in seconds since 1970.
  [[nodiscard]] double date();
  void print(std::string text);
  void warn_once(std::string text);
  void request(ScriptRequest request);
  /// A field or eventOut of the running Script was written.
  void own_changed(Program& program, std::uint32_t place);
  /// An event for a node, when the function is over: the last one of each eventIn, but for those that add and remove.
  bool post(JSContext* context, vrml::SceneGraph& scene, vrml::NodeId node, const vrml::InterfaceDeclaration& event_in,
            vrml::FieldValue value);
  /// What was posted so far and is not sent; null: nothing.
  [[nodiscard]] const vrml::FieldValue* posted(const vrml::SceneGraph& scene, vrml::NodeId node,
                                               const vrml::InterfaceDeclaration& event_in) const;
  /// The list was changed that was read from a node.
  bool note_changed(JSContext* context, JS::HandleObject list);
  bool flush_changed(JSContext* context);
  /// New nodes of a text, or an exception.
  bool create_from_string(JSContext* context, std::string_view text, vrml::MFNode& nodes, vrml::SceneGraph*& scene);
  [[nodiscard]] const JS::PersistentRootedObject& library() const { return library_; }
  /// Whether the library has it for all programs.
  [[nodiscard]] static bool is_own_name(std::string_view name);

  static constexpr int kMatrixPrototype = vrml::kFieldTypeCount, kRowPrototype = kMatrixPrototype + 1;

 private:
  struct Post {
    vrml::SceneGraph* scene;
    vrml::NodeId node;
    const vrml::InterfaceDeclaration* event_in;
    vrml::FieldValue value;
  };
  bool make_library();
  Program* program_of(vrml::EventNode node) const;
  /// Tries what has not been tried of its urls.
  bool go_on(vrml::EventNode node);
  bool load(Program& program, std::string_view text, const std::string& file, vrml::SourceLocation place);
  /// A program's text as the engine takes it, with the names of its own fields.
  [[nodiscard]] std::string modern_text_of(const Program& program, std::string_view text);
  bool make_global(Program& program);
  /// Has the engine do something in the program's name; then sends what it has assigned.
  template <class Do>
  void run(Program& program, const Do& what);
  void call(Program& program, const char* name);
  void send_all(Program& program);
  void report_exception(Program& program);
  void tell(ScriptMessage message);
  void report(vrml::Severity severity, const Program& program, std::string message,
              std::optional<vrml::Diagnostic> at = {});
  void fault(Program& program, const std::string& why, std::optional<vrml::Diagnostic> at = {});
  [[nodiscard]] std::string label(const Program& program) const;

  vrml::Execution& execution_;
  Engine& engine_;
  Settings settings_;
  std::shared_ptr<Link> link_ = std::make_shared<Link>();
  JS::PersistentRootedObject library_;
  std::vector<JS::PersistentRootedObject> prototypes_;
  std::unordered_map<vrml::EventNode, std::unique_ptr<Program>> programs_;
  struct Text {
    std::optional<std::string> text;
    std::string url;
  };
  std::unordered_map<vrml::EventNode, Text> texts_;  // that have come, and their urls
  Program* running_ = nullptr;
  std::vector<Post> posts_;
  std::unordered_map<std::uint64_t, std::size_t> last_posts_;  // by node and eventIn
  JS::PersistentRooted<JS::StackGCVector<JSObject*>> changed_;
  std::vector<ScriptMessage> messages_;
  std::function<void(const ScriptMessage&)> observer_;
  std::vector<ScriptRequest> requests_;
  std::unordered_set<std::string> said_;
  BrowserState browser_;
  std::chrono::steady_clock::duration spent_{}, longest_{};  // in this step: of all, of one call
  vrml::EventNode slowest_ = 0;                              // whose that was
  bool late_ = false, ends_ = false;
  std::uint32_t clock_looks_ = 0;  // of the function that runs
  std::uint64_t random_ = 0x9e3779b97f4a7c15U;
};

/// The world whose program calls.
[[nodiscard]] World& world_of(JSContext* context);
[[nodiscard]] Program* program_of_global(JSObject* global);

// globals.cpp
/// `beside`: in whose compartment; null: in one of its own, in a zone of its own.
JSObject* new_global(JSContext* context, Program* program, JS::HandleObject beside);
void forget_program(JSObject* global);

// programs.cpp
/// With what the engine refuses mended, if that helps. Else an exception, of the text as it is.
JSScript* compile_mended(JSContext* context, const std::string& text, const std::string& file,
                         vrml::SourceLocation place);
/// What the pending exception says, which is none any more; nothing: it says nothing. `recursion`: it is that.
std::optional<vrml::Diagnostic> take_exception(JSContext* context, bool& recursion);

// values.cpp
/// Where a value was read from, that goes there again when a part of it is assigned: a global object (place: of an
/// interface), a list (place: index), a node (place: of an interface of its type).
struct Source {
  JSObject* parent = nullptr;
  std::uint32_t place = 0;
};
bool to_value(JSContext* context, vrml::SceneGraph* scene, const vrml::FieldValue& field, Source source,
              JS::MutableHandleValue value);
/// Nodes must be of `scene`. False with an exception.
bool to_field(JSContext* context, JS::HandleValue value, vrml::FieldType type, vrml::SceneGraph* scene,
              vrml::FieldValue& field);
/// A part of a value was assigned: writes the whole to where it was read from.
bool write_back(JSContext* context, JS::HandleObject parent, std::uint32_t place, JS::HandleValue value);
bool set_own(JSContext* context, Program& program, std::uint32_t place, JS::HandleValue value);
bool text_of_value(JSContext* context, JS::HandleValue value, std::string& text);
bool make_string(JSContext* context, std::string_view text, JS::MutableHandleValue value);
bool fail(JSContext* context, const std::string& why);

// tuples.cpp: SFColor, SFRotation, SFVec2f, SFVec3f
bool define_tuples(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);
JSObject* make_tuple(JSContext* context, vrml::FieldType type, const double* components, Source source = {});
/// The type and components; nothing where the object is none.
[[nodiscard]] bool is_tuple(JSObject* object, vrml::FieldType& type, double* components);

// lists.cpp: the MF types
bool define_lists(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);
JSObject* make_list(JSContext* context, ListBox box, Source source);
[[nodiscard]] ListBox* list_of(JSObject* object);
[[nodiscard]] vrml::FieldValue* list_value(ListBox& box);
bool set_element(JSContext* context, JS::HandleObject list, std::uint32_t index, JS::HandleValue value);
bool flush_list(JSContext* context, JS::HandleObject list);

// nodes.cpp: SFNode
bool define_nodes(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);
JSObject* object_of_node(JSContext* context, vrml::SceneGraph& scene, vrml::NodeId id);
[[nodiscard]] NodeBox* node_of(JSObject* object);
bool set_node_field(JSContext* context, JS::HandleObject node, std::uint32_t place, JS::HandleValue value);

// images.cpp: SFImage
bool define_images(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);
JSObject* make_image(JSContext* context, const vrml::PixelImage& image, Source source);
[[nodiscard]] bool is_image(JSObject* object);
bool image_of(JSContext* context, JS::HandleObject object, vrml::PixelImage& image);
/// An element of its array was assigned.
bool image_array_changed(JSContext* context, JS::HandleObject image);

// matrices.cpp
bool define_matrices(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);

// browser.cpp
bool define_browser(JSContext* context, JS::HandleObject library);

// old_programs.cpp
/// The text with what assignments mean in Annex C. `values`: names of fields and eventOuts whose values are objects.
/// Lines stay where they are.
[[nodiscard]] std::string modern_text(std::string_view text, const std::vector<std::string>& values);
/// Of one that the engine refuses: with line ends in strings, names that are reserved words by now, VRML's comments and
/// such as do not end, `for each` and functions without braces of JavaScript 1.6 and 1.8, and braces that do not match.
[[nodiscard]] std::string mended_text(std::string_view text);

}  // namespace gs::app::script
