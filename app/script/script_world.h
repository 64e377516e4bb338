#pragma once

#include "app/script/engine.h"
#include "app/script/habits/contact_habits.h"
#include "app/script/read_rule.h"
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

// Implementation of ScriptRunner. Each Script has its own global object, so names without `var` belong to one Script.
// The objects of VRML97's types form a library, which the Scripts of one site or local file share (read_rule.h).
namespace gs::app::script {

class World;
struct ScriptLibrary;

/// Attributes of properties that can be enumerated but not deleted.
constexpr unsigned kProperty = JSPROP_ENUMERATE | JSPROP_PERMANENT;

/// Script and its program.
struct Program {
  World* world = nullptr;
  ScriptLibrary* library = nullptr;
  vrml::EventNode node = 0;
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId id;
  std::shared_ptr<const vrml::TextSource> source;  // source of the text that contains the url field
  /// Cached decisions of may_read(), by the source of the node. The shared pointers keep the keys valid.
  std::unordered_map<const vrml::TextSource*, std::pair<std::shared_ptr<const vrml::TextSource>, Reading>> readings;
  JS::PersistentRootedObject global;
  std::vector<jsid> names;                                         // by index in the node type's interfaces
  std::vector<std::unique_ptr<JS::PersistentRootedObject>> lists;  // objects of MF fields and eventOuts, by the index
                                                                   // of `names`
  std::vector<bool> unsent;                                        // eventOuts with unsent values; by index of `names`
  std::vector<std::uint32_t> to_send;
  std::vector<std::size_t> counted;  // by index of `names`: bytes that count against the heap of programs
  bool runs = false, waits = false, off = false, has_processed = false, told_direct = false;
  bool ended = false;  // shutdown() was called
  int faults = 0;
  std::string late_message;  // see Engine::on_overdue()
  std::size_t next_url = 0;  // index of the first entry of the url field that was not tried yet
  UndeclaredNames undeclared;
};

/// Key of a node in any scene of a world. A NodeId alone is unique only within its scene.
struct NodeKey {
  std::uint64_t scene = 0;  // SceneGraph::serial
  vrml::NodeId id;
  friend bool operator==(const NodeKey&, const NodeKey&) = default;
};
struct HashNodeKey {
  std::size_t operator()(const NodeKey& key) const {
    return static_cast<std::size_t>(
        ((std::uint64_t{key.id.generation} << 32 | key.id.index) + key.scene * 0x85ebca6bU) * 0x9e3779b97f4a7c15U);
  }
};

/// Part of a library that outlives its world, because objects may be collected later.
struct Link {
  vrml::Execution* execution = nullptr;                         // null after the world is destroyed
  std::unordered_map<NodeKey, JSObject*, HashNodeKey> objects;  // objects of nodes
};

/// Scene to which a value of a program belongs. The scene may be removed during the life of the value.
class SceneRef {
 public:
  SceneRef() = default;
  SceneRef(vrml::SceneGraph* scene) : scene_(scene), serial_(scene ? scene->serial() : 0) {}
  /// Returns the scene; null if it is no longer part of the world.
  [[nodiscard]] vrml::SceneGraph* in(const Link* link) const {
    return scene_ && link && link->execution && link->execution->scenes().has(scene_) && scene_->serial() == serial_
               ? scene_
               : nullptr;
  }
  [[nodiscard]] std::uint64_t serial() const { return serial_; }

 private:
  vrml::SceneGraph* scene_ = nullptr;
  std::uint64_t serial_ = 0;
};

/// Data of an SFNode object. The node is held as long as the object exists.
struct NodeBox {
  std::shared_ptr<Link> link;
  SceneRef scene;
  vrml::NodeId id;
  /// Returns the node's scene; null if the node is no longer part of the world.
  [[nodiscard]] vrml::SceneGraph* live_scene() const {
    vrml::SceneGraph* const in_world = scene.in(link.get());
    return in_world && in_world->contains(id) ? in_world : nullptr;
  }
};

/// Data of an MF object: of a Script's own field or eventOut, or a separate value.
struct ListBox {
  std::shared_ptr<Link> link;
  Engine* engine = nullptr;
  Program* program = nullptr;  // owner of the field or eventOut; null for a separate value
  std::uint32_t place = 0;
  vrml::FieldType type = vrml::FieldType::MFInt32;
  SceneRef scene;          // scene of the nodes of an MFNode
  vrml::FieldValue value;  // unused if there is a `program`
  std::vector<vrml::NodeId> held;
  std::size_t counted = 0;  // bytes that count against the heap of programs
  bool changed = false;     // the value must still be sent to the node or image from which the list was read
};

/// Objects of VRML97's types and of the browser. They have their own compartment.
struct ScriptLibrary {
  World* world = nullptr;
  std::shared_ptr<Link> link = std::make_shared<Link>();
  JS::PersistentRootedObject global;
  std::vector<JS::PersistentRootedObject> prototypes;
  std::unordered_map<std::string, std::string> options;  // values of Browser.setOption()

  explicit ScriptLibrary(World& of, JSContext* context);
  [[nodiscard]] JSObject* prototype(vrml::FieldType type) const { return prototypes[static_cast<std::size_t>(type)]; }
  [[nodiscard]] JSObject* matrix_prototype() const { return prototypes[kMatrixPrototype]; }
  [[nodiscard]] JSObject* row_prototype() const { return prototypes[kRowPrototype]; }
  static constexpr int kMatrixPrototype = vrml::kFieldTypeCount, kRowPrototype = kMatrixPrototype + 1;
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
  [[nodiscard]] std::vector<ScriptRequest> take_requests() override {
    request_bytes_ = 0;
    return std::exchange(requests_, {});
  }
  void forget_scene(const vrml::SceneGraph& scene) override;
  [[nodiscard]] const std::string& private_file() const override { return private_file_; }
  [[nodiscard]] bool is_late() const override { return late_; }

  // Functions for calls from programs.
  [[nodiscard]] vrml::Execution& execution() { return execution_; }
  [[nodiscard]] Engine& engine() { return engine_; }
  [[nodiscard]] const BrowserState& browser() const { return browser_; }
  /// Returns the program that the engine is running.
  [[nodiscard]] Program& running() { return *running_; }
  [[nodiscard]] bool ends() const { return ends_; }
  [[nodiscard]] double random();
  [[nodiscard]] bool is_repeatable() const { return settings_.repeatable; }
  /// Returns the time for Date in seconds since 1970, in simulated time.
  [[nodiscard]] double date();
  void print(std::string text);
  /// Reports a warning about the running program, unless it was reported before. `at` is its position, if known.
  void warn_once(std::string text, std::optional<Diagnostic> at = {});
  void request(ScriptRequest request);
  /// Records that a field or eventOut of the running Script was written.
  void own_changed(Program& program, std::uint32_t place);
  /// Stores an event for a node until the function ends. Only the last event of each eventIn is kept, except for MFNode
  /// eventIns, which add or remove nodes.
  bool post(JSContext* context, vrml::SceneGraph& scene, vrml::NodeId node, const vrml::InterfaceDeclaration& event_in,
            vrml::FieldValue value);
  /// Returns the value of the stored event for an eventIn; null if there is none.
  [[nodiscard]] const vrml::FieldValue* posted(const vrml::SceneGraph& scene, vrml::NodeId node,
                                               const vrml::InterfaceDeclaration& event_in) const;
  /// Applies the stored addChildren and removeChildren events of a node to the value of its `children`.
  void add_posted_children(const vrml::SceneGraph& scene, vrml::NodeId node, const vrml::InterfaceDeclaration& children,
                           vrml::FieldValue& value) const;
  /// Records that a list was changed that was read from a node.
  bool note_changed(JSContext* context, JS::HandleObject list);
  bool flush_changed(JSContext* context);
  /// Makes nodes from VRML text. Throws an exception and returns false on failure.
  bool create_from_string(JSContext* context, std::string_view text, vrml::MFNode& nodes, vrml::SceneGraph*& scene);
  /// Reports whether the running program may read this node. Records the first confidential read; warns once about
  /// refused reads.
  bool may_read(const vrml::Node& node);
  /// Reports whether the library provides this name to every program.
  [[nodiscard]] static bool is_own_name(std::string_view name);

  static constexpr char kLate[] = "the program exceeded the time limit";

 private:
  struct PostKey {
    NodeKey node;
    const vrml::InterfaceDeclaration* event_in;
    friend bool operator==(const PostKey&, const PostKey&) = default;
  };
  struct HashPostKey {
    std::size_t operator()(const PostKey& key) const {
      return HashNodeKey()(key.node) ^ std::hash<const void*>()(key.event_in);
    }
  };
  struct Post {
    vrml::SceneGraph* scene;
    vrml::NodeId node;
    const vrml::InterfaceDeclaration* event_in;
    vrml::FieldValue value;
  };
  ScriptLibrary* library_of_source(const std::shared_ptr<const vrml::TextSource>& source);
  bool make_library(ScriptLibrary& library);
  void run_jobs(Program& program, Engine::Turn& turn);
  Program* program_of(vrml::EventNode node) const;
  /// Tries the remaining entries of the Script's url field. Returns true if a program began.
  bool go_on(vrml::EventNode node);
  bool load(Program& program, std::string_view text, const std::string& file, SourceLocation place);
  /// Returns the text of a program's code in modern ECMAScript; see modern_text().
  [[nodiscard]] std::string modern_text_of(const Program& program, std::string_view text);
  bool make_global(Program& program);
  /// Runs `what` in the global object of a program and within its limits. Then sends the events of its assignments.
  template <class Do>
  void run(Program& program, const Do& what);
  void call(Program& program, const char* name);
  void send_all(Program& program);
  void report_exception(Program& program);
  void report_failure(Program& program, const Engine::Turn& turn);
  void tell(ScriptMessage message);
  void report(Severity severity, const Program& program, std::string message, std::optional<Diagnostic> at = {});
  void fault(Program& program, const std::string& why, std::optional<Diagnostic> at = {});
  [[nodiscard]] std::string label(const Program& program) const;
  [[nodiscard]] std::string late_message(const Program& program) const;

  vrml::Execution& execution_;
  Engine& engine_;
  Settings settings_;
  std::unordered_map<std::string, std::unique_ptr<ScriptLibrary>> libraries_;  // by library_key()
  std::string private_file_;
  std::unordered_map<vrml::EventNode, std::unique_ptr<Program>> programs_;
  struct Text {
    std::optional<std::string> text;
    std::string url;
  };
  std::unordered_map<vrml::EventNode, Text> texts_;  // received texts of programs that have not begun, with their URLs
  Program* running_ = nullptr;
  std::vector<Post> posts_;
  std::size_t post_bytes_ = 0, request_bytes_ = 0;  // bytes of values in posts_ and of texts in requests_
  std::unordered_map<PostKey, std::size_t, HashPostKey> last_posts_;
  JS::PersistentRooted<JS::StackGCVector<JSObject*>> changed_;
  std::vector<ScriptMessage> messages_;
  std::function<void(const ScriptMessage&)> observer_;
  std::vector<ScriptRequest> requests_;
  std::unordered_set<std::string> said_;
  BrowserState browser_;
  std::chrono::steady_clock::duration spent_{}, longest_{};  // in this step: time of all calls, and of the longest call
  vrml::EventNode slowest_ = 0;                              // Script of the longest call
  bool late_ = false, ends_ = false;
  std::uint32_t clock_looks_ = 0;  // number of reads of the clock in the running function
  std::uint64_t random_ = 0x9e3779b97f4a7c15U;
};

/// Returns the library of the calling program. world_of() returns its world.
[[nodiscard]] ScriptLibrary& library_of(JSContext* context);
[[nodiscard]] World& world_of(JSContext* context);
[[nodiscard]] Program* program_of_global(JSObject* global);

/// Returns the text that contains the url field of a Script.
[[nodiscard]] const vrml::SourceText& text_of_program(const Program& program);

// globals.cpp
/// Creates a global object in the compartment of `beside`. If `beside` is null, creates a new compartment and zone.
JSObject* new_global(JSContext* context, Program* program, JS::HandleObject beside);
void forget_program(JSObject* global);

// programs.cpp
/// Compiles a program. If this fails, tries again with mended_text(). If both fail, throws the exception of the
/// original text and returns null.
JSScript* compile_mended(JSContext* context, const std::string& text, const std::string& file, SourceLocation place);
/// Clears the pending exception and returns its text; nullopt if it has none. Sets `recursion` if endless recursion
/// caused the exception.
std::optional<Diagnostic> take_exception(JSContext* context, bool& recursion);

// values.cpp
/// Origin of a value that was read. When a part of the value is assigned, the whole value is written back there. If
/// `parent` is a global object or a node, `place` is the index of an interface. If it is a list, `place` is the index
/// of an element.
struct Source {
  JSObject* parent = nullptr;
  std::uint32_t place = 0;
};
bool to_value(JSContext* context, vrml::SceneGraph* scene, const vrml::FieldValue& field, Source source,
              JS::MutableHandleValue value);
/// Converts a value to a field value. Its nodes must belong to `scene`. Throws an exception and returns false on
/// failure.
bool to_field(JSContext* context, JS::HandleValue value, vrml::FieldType type, vrml::SceneGraph* scene,
              vrml::FieldValue& field);
/// Writes a value of which a part was assigned back to the object from which it was read; see Source.
bool write_back(JSContext* context, JS::HandleObject parent, std::uint32_t place, JS::HandleValue value);
bool set_own(JSContext* context, Program& program, std::uint32_t place, JS::HandleValue value);
bool text_of_value(JSContext* context, JS::HandleValue value, std::string& text);
/// Converts a value to text and keeps the first `most` characters.
bool cut_text_of_value(JSContext* context, JS::HandleValue value, std::size_t most, std::string& text);
bool make_string(JSContext* context, std::string_view text, JS::MutableHandleValue value);
bool fail(JSContext* context, const std::string& why);

// tuples.cpp: SFColor, SFRotation, SFVec2f, SFVec3f
bool define_tuples(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);
JSObject* make_tuple(JSContext* context, vrml::FieldType type, const double* components, Source source = {});
/// Returns the type and the components. Returns false if the object is no tuple.
[[nodiscard]] bool is_tuple(JSObject* object, vrml::FieldType& type, double* components);

// lists.cpp: the MF types
bool define_lists(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);
JSObject* make_list(JSContext* context, ListBox box, Source source);
[[nodiscard]] ListBox* list_of(JSObject* object);
[[nodiscard]] vrml::FieldValue* list_value(ListBox& box);
bool set_element(JSContext* context, JS::HandleObject list, std::uint32_t index, JS::HandleValue value);
bool flush_list(JSContext* context, JS::HandleObject list);
/// Detaches a list from the Script's field or eventOut. The result is a separate, empty list of the same type.
void forget_program_of_list(ListBox& box);

// nodes.cpp: SFNode
bool define_nodes(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);
JSObject* object_of_node(JSContext* context, vrml::SceneGraph& scene, vrml::NodeId id);
[[nodiscard]] NodeBox* node_of(JSObject* object);
/// Reports whether an event to this eventIn would replace the program of a Script.
[[nodiscard]] bool sets_program(const vrml::NodeType& type, const vrml::InterfaceDeclaration& event_in);
bool set_node_field(JSContext* context, JS::HandleObject node, std::uint32_t place, JS::HandleValue value);

// images.cpp: SFImage
bool define_images(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);
JSObject* make_image(JSContext* context, const vrml::PixelImage& image, Source source);
[[nodiscard]] bool is_image(JSObject* object);
bool image_of(JSContext* context, JS::HandleObject object, vrml::PixelImage& image);
/// Writes an image back after an assignment to an element of its array.
bool image_array_changed(JSContext* context, JS::HandleObject image);

// matrices.cpp
bool define_matrices(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes);

// browser/browser.cpp
bool define_browser(JSContext* context, JS::HandleObject library);
/// Reports whether the Browser object has a method with this name.
[[nodiscard]] bool is_browser_method(std::string_view name);

// legacy_vrmlscript.cpp
/// Rewrites assignments so that they copy, as in Annex C. `values` holds the names of the fields and eventOuts with
/// values that ECMAScript would share. Keeps line numbers.
[[nodiscard]] std::string modern_text(std::string_view text, const std::vector<std::string>& values);
/// Corrects constructs that the engine refuses. These are line ends in strings, names that became reserved words, VRML
/// comments, comments without an end, and unbalanced braces. Also rewrites `for each` of JavaScript 1.6 and functions
/// without braces of JavaScript 1.8.
[[nodiscard]] std::string mended_text(std::string_view text);

}  // namespace gs::app::script
