#include "app/world/scene_handler.h"
#include "app/formats/common/asset.h"
#include "base/text.h"
#include "vrml/scene/prototype.h"

#include <algorithm>
#include <chrono>
#include <utility>

// Decoding of scenes to nodes. scene_references.cpp handles the references of the nodes.
namespace gs::app {
namespace {}  // namespace

SceneHandler::SceneHandler(World& world, Role given_role, SceneHandler* given_outer)
    : role(given_role), outer(given_outer), world_(world), waiting_share_(world.budget, Resource::files) {}

SceneHandler::~SceneHandler() = default;

bool SceneHandler::leads_back(const Found& found) const {
  std::size_t depth = 0;
  for (const SceneHandler* scene_handler = outer; scene_handler; scene_handler = scene_handler->outer, ++depth)
    if (scene_handler->found_.url.text() == found.url.text() || depth >= world_.budget->limits().inline_depth)
      return true;
  return false;
}

bool SceneHandler::begin(const Found& found) {
  if (outer && leads_back(found)) {
    world_.report(Severity::error, place_file, place, what + " refers back to " + found.path + "; left out");
    content = Content::refused;
    finished_reading();
    return false;
  }
  errors_before_ = world_.world.diagnostics.errors();
  found_ = found;
  own_ = std::make_unique<vrml::SceneGraph>(found.path, world_.budget);
  scene = own_.get();
  own_->set_source(source_of(found.origin));
  return true;
}

bool SceneHandler::whole_file(const net::MappedFile& file, const std::string& path) {
  const auto bytes = file.bytes();
  type_ = &content_type_of(path, first_bytes(bytes));
  note_type();
  if (type_->content == ContentClass::vrml || is_outline_stream(bytes)) return false;
  bytes_ = bytes.size();
  if (type_->is_cloud())
    (void)cloud_handler().whole_file(file, path);
  else
    read_mesh(bytes);
  if (type_->is_cloud() && !cloud_node_) content = Content::refused;
  stage_ = Stage::read_at_once;
  return true;
}

void SceneHandler::receive(std::span<const std::byte> bytes) {
  bytes_ += bytes.size();
  if (refused()) return;
  if (!type_ || type_->content == ContentClass::mesh) {
    if (!waiting_share_.grow(bytes.size())) {
      report(Severity::error, {}, world_.budget->refusal(Resource::files) + "; left out");
      content = Content::refused;
      waiting_ = {};
      return;
    }
    waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
    if (type_ || !choose_type(false)) return;
    bytes = waiting_;
    if (type_->content == ContentClass::mesh) return;
    read_rest(bytes);
    waiting_ = {};
    waiting_share_.shrink_to(0);
    return;
  }
  read_rest(bytes);
}

// Sets the world's properties that depend on the file type.
void SceneHandler::note_type() {
  if (role != Role::root) return;
  world_.world.up = type_->up;
  world_.world.authored = type_->content == ContentClass::vrml;
}

// Detects the type from the first bytes, the name, or the server's answer. Returns false if it needs more bytes.
bool SceneHandler::choose_type(bool last) {
  if (!last && waiting_.size() < kTypeBytes) return false;
  const std::string name = found_.local ? found_.path : found_.url.path;
  const auto first = first_bytes(waiting_);
  type_ = content_type_by_mark(first);
  if (!type_) type_ = &content_type_of(name, first);
  note_type();
  return true;
}

void SceneHandler::read_rest(std::span<const std::byte> bytes) {
  if (!outlines_ && !cloud_handler_ && type_->is_cloud() && is_outline_stream(bytes))
    outlines_ = std::make_unique<OutlineReader>(world_, *scene);
  if (outlines_) {
    outlines_->receive(bytes);
    return show_outlines();
  }
  if (type_->is_cloud()) return cloud_handler().receive(bytes);
  if (!parser_) parser_.emplace(*scene, world_.world.diagnostics);
  if (packing_ == Packing::unknown) {
    packing_ = is_gzip(bytes) ? Packing::gzip : Packing::plain;
    if (packing_ == Packing::gzip) gunzip_ = std::make_unique<Gunzip>(world_.budget);
  }
  parse(bytes);
  world_.changed = true;
  attach();
  look_for_references();
}

void SceneHandler::parse(std::span<const std::byte> bytes) {
  const PhaseScope phase(world_.options.phases, Phase::parse);
  if (gunzip_)
    gunzip_->push(bytes, [this](std::string_view piece) {
      parser_->push(piece);
      return !scene->exhausted();
    });
  else
    parser_->push(text_of(bytes));
}

CloudHandler& SceneHandler::cloud_handler() {
  if (!cloud_handler_) {
    const std::weak_ptr<SceneHandler> self = weak_from_this();
    cloud_handler_ = std::make_shared<CloudHandler>(world_, CloudHandler::Place{found_.path, {}, {}, false},
                                                    [self](const std::shared_ptr<const qnv::Cloud>& cloud) {
                                                      if (const auto handler = self.lock()) handler->show_cloud(cloud);
                                                    });
    cloud_handler_->begin(found_);
  }
  cloud_handler_->cut = cut;
  return *cloud_handler_;
}

void SceneHandler::show_outlines() {
  if (role == Role::root) world_.world.stated_up = outlines_->upright();
  for (const vrml::NodeId id : outlines_->take_changed()) outlines_changed(id);
  attach();
  look_for_references();  // textures
}

void SceneHandler::outlines_changed(vrml::NodeId id) {
  shown_open_.push_back(&scene->node(id));
  world_.changed = true;
}

void SceneHandler::read_mesh(std::span<const std::byte> bytes) {
  const PhaseScope phase(world_.options.phases, Phase::parse);
  auto read = import_scene(
      *type_, {bytes, found_.path, world_.reader_of(found_.origin), world_.budget, world_.world.diagnostics});
  if (!read) content = Content::refused;
  if (!read) return;
  own_ = std::move(read);
  scene = own_.get();
  own_->set_source(source_of(found_.origin));
  world_.changed = true;
}

void SceneHandler::show_cloud(const std::shared_ptr<const qnv::Cloud>& cloud) {
  if (!cloud_node_) {
    const std::string path = found_.local ? net::url_of_path(found_.path).path : found_.url.path;
    cloud_node_ = add_cloud_shape(*scene, *cloud, path.substr(path.rfind('/') + 1));
    if (!cloud_node_) return;
    if (role == Role::root) world_.world.stated_up = stated_upright(cloud->description.metadata);
    attach();
  }
  world_.cloud_arrived({{scene, cloud_node_}, {}, cloud});
}

void SceneHandler::end(const std::optional<std::string>& problem) {
  if (problem) {
    world_.report(Severity::error, found_.path, {}, *problem);
    cut_short();
  }
  if (stage_ != Stage::read_at_once && !refused()) {
    if (!type_) choose_type(true);
    if (type_->content == ContentClass::mesh) {
      read_mesh(std::exchange(waiting_, {}));
    } else if (type_->is_cloud() && !cloud_handler_ && !outlines_ && is_outline_stream(waiting_)) {
      read_rest(std::exchange(waiting_, {}));
    }
    if (outlines_) {
      outlines_->end(found_.path, !cut && !problem);
      show_outlines();
      if (outlines_->empty()) content = Content::refused;
      outlines_.reset();
    } else if (type_->is_cloud()) {
      if (!cloud_handler_) read_rest(std::exchange(waiting_, {}));
      cloud_handler().cut = cut || problem;
      cloud_handler_->end(std::nullopt);
      if (!cloud_node_) content = Content::refused;
    } else if (type_->content == ContentClass::vrml) {
      if (!parser_) read_rest(std::exchange(waiting_, {}));
      end_text(problem.has_value());
    }
  }
  if (refused() && world_.world.diagnostics.errors() == errors_before_)
    world_.report(Severity::error, found_.path, {}, "has nothing to show");
  world_.changed = true;
  finished_reading();
}

void SceneHandler::end_text(bool had_problem) {
  if (gunzip_) {
    if (const auto damage = gunzip_->finish(); damage && !cut && !had_problem) {
      report(Severity::error, {}, *damage);
      cut_short();
    }
  }
  const vrml::ParseOutcome outcome = parser_->finish();
  if (outcome == vrml::ParseOutcome::refused)
    content = Content::refused;
  else if (outcome != vrml::ParseOutcome::complete && !cut)
    cut_short();
  parser_.reset();
  if (!had_problem && !cut) complete_outlines();
}

// Marks all outline groups as complete, because the file has ended.
void SceneHandler::complete_outlines() {
  for (std::uint32_t i = 1; i <= scene->node_count(); ++i) {
    const vrml::NodeId id = scene->id_at(i);
    const vrml::Node& node = scene->node_at(i);
    if (node.type->url_content != vrml::UrlContent::outlines) continue;
    scene->set<vrml::SFBool>(id, "complete", true);
    shown_open_.push_back(&node);
  }
}

bool SceneHandler::seek(RangedStream::Place place_in_stream) {
  if (!cloud_handler_ || !cloud_handler_->seek(std::move(place_in_stream))) return false;
  finished_reading();
  return true;
}

void SceneHandler::receive_cells(const net::CellEvent& event) {
  bytes_ += event.bytes.size();
  if (cloud_handler_) cloud_handler_->receive_cells(event);
  if (!outlines_) return;
  outlines_->receive_cells(event);
  show_outlines();
}

std::shared_ptr<StreamFeed> SceneHandler::follow() {
  auto feed = cloud_handler_ ? cloud_handler_->follow() : nullptr;
  if (feed) finished_reading();
  return feed;
}

void SceneHandler::missing(const std::string& why) {
  content = Content::refused;
  if (!outer)
    world_.report(Severity::error, world_.world.path, {}, why.empty() ? "cannot be found" : why);
  else if (role == Role::library)
    outer->miss_prototypes(*this, told ? std::nullopt : std::optional<std::string>(why));
  else if (!told)
    world_.report(Severity::warning, place_file, place, what + ": " + why_missing(urls, why));
  finished_reading();
}

// Ends the reading of the file itself.
void SceneHandler::finished_reading() {
  stage_ = std::max(stage_, Stage::ended);
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - world_.started).count();
  if (!refused()) {
    attach();
    resolve_types();
    look_for_references();
  }
  settle();
}

// Attaches an Inline's content as soon as it has nodes.
void SceneHandler::attach() {
  if (role != Role::inlined || given_to || !own_ || refused() || own_->roots().empty()) return;
  outer->scene->attach_inline(inline_node, std::move(own_));
}

// Hands a library to its user once the libraries that it uses are loaded.
void SceneHandler::settle() {
  if (stage_ == Stage::settled || !nothing_more_comes() || awaited_libraries_ > 0) return;
  stage_ = Stage::settled;
  if (role != Role::library) return;
  outer->take_library(*this);
}

// Forgets the meshes of nodes that were incomplete when they were shown.
void SceneHandler::forget_open(render::MeshCache& meshes) {
  if (!scene) return;
  for (const vrml::Node* node : shown_open_) meshes.forget(node);
  shown_open_.clear();
  if (parser_)
    for (const vrml::NodeId id : parser_->open_nodes()) {
      shown_open_.push_back(&scene->node(id));
      meshes.forget(shown_open_.back());
      // The group that it refines changes with it.
      if (shown_open_.back()->type->url_content != vrml::UrlContent::outlines) continue;
      const auto refined = scene->resolve_as(scene->get<vrml::SFNode>(id, "refines"), vrml::NodeKind::outline_group);
      if (!refined) continue;
      shown_open_.push_back(&scene->node(refined));
      meshes.forget(shown_open_.back());
    }
  for (const auto& inner : inner_) inner->forget_open(meshes);
}

std::unique_ptr<vrml::SceneGraph> SceneHandler::give_root() {
  if (refused()) own_.reset();
  give_away();
  return std::move(own_);
}

std::shared_ptr<vrml::SceneGraph> SceneHandler::give_content() {
  if (refused()) return nullptr;
  std::shared_ptr<vrml::SceneGraph> given = content_ ? std::move(content_) : std::move(own_);
  if (!given) return nullptr;
  given_ = given;
  give_away();
  return given;
}

// Hands over the scene with all complete Inlines; the others follow.
void SceneHandler::give_away() {
  owner_ = Owner::world_runtime;
  if (!scene || refused()) return;
  for (const auto& one : libraries_)
    if (one->stage_ == Stage::settled && one->owner_ == Owner::reader) one->give_away();
  for (const auto& one : inner_) {
    const bool is_attached = one->scene && scene->inlined(one->inline_node) == one->scene;
    if (one->nothing_more_comes()) {
      if (!is_attached) continue;
      one->given_ = scene->inlines().at(one->inline_node.index);
      one->give_away();
      continue;
    }
    if (is_attached) {
      one->content_ = scene->inlines().at(one->inline_node.index);
      scene->attach_inline(one->inline_node, nullptr);
    }
    one->given_to = Arrivals::Place{scene, one->inline_node};
    world_.withheld.push_back(one);
  }
}

}  // namespace gs::app
