#include "app/loading/content/scene_content.h"

#include "app/base/temporary_file.h"
#include "app/formats/common/asset.h"
#include "app/formats/confined/confined_import.h"
#include "app/loading/content/scene_target.h"
#include "app/loading/fetch/partial_file.h"
#include "app/loading/resources/geometry_handler.h"
#include "app/loading/resources/outline_reader.h"
#include "base/gzip.h"
#include "base/text.h"
#include "vrml/syntax/scene_reader.h"

#include <utility>

namespace gs::app {
namespace {

/// Text of any grammar of vrml/, which may be gzip-compressed.
class TextContent final : public SceneContent {
 public:
  TextContent(SceneTarget& target, vrml::Grammar grammar)
      : target_(target), reader_(vrml::make_reader(grammar, *target.scene(), target.loading().results.diagnostics())) {}

  void receive(std::span<const std::byte> bytes) override {
    if (packing_ == Packing::unknown) {
      packing_ = is_gzip(bytes) ? Packing::gzip : Packing::plain;
      if (packing_ == Packing::gzip) gunzip_ = std::make_unique<Gunzip>(target_.loading().budget);
    }
    parse(bytes);
    target_.loading().results.set_changed(true);
    target_.add_nodes();
  }
  void end(bool damaged) override {
    if (gunzip_) {
      if (const auto damage = gunzip_->finish(); damage && !cut && !damaged) {
        target_.report(Severity::error, {}, *damage);
        target_.cut_short();
      }
    }
    const vrml::ParseOutcome outcome = reader_->finish();
    if (outcome == vrml::ParseOutcome::refused)
      target_.refuse();
    else if (outcome != vrml::ParseOutcome::complete && !cut)
      target_.cut_short();
    reader_.reset();
    if (!damaged && !cut) complete_outlines();
  }
  [[nodiscard]] std::vector<vrml::NodeId> open_nodes() const override {
    return reader_ ? reader_->open_nodes() : std::vector<vrml::NodeId>();
  }

 private:
  void parse(std::span<const std::byte> bytes) {
    const PhaseScope phase(target_.loading().options.phases, Phase::parse);
    if (gunzip_)
      gunzip_->push(bytes, [this](std::string_view piece) {
        reader_->push(piece);
        return !target_.scene()->memory().exhausted();
      });
    else
      reader_->push(text_of(bytes));
  }
  // Marks all outline groups as complete. Called at the end of the file.
  void complete_outlines() {
    vrml::SceneGraph& scene = *target_.scene();
    for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
      const vrml::NodeId id = scene.nodes().id_at(i);
      if (scene.nodes().at(i).type->url_content != vrml::UrlContent::outlines) continue;
      scene.set<vrml::SFBool>(id, "complete", true);
      target_.node_changed(id);
    }
  }

  SceneTarget& target_;
  std::unique_ptr<vrml::SceneReader> reader_;
  std::unique_ptr<Gunzip> gunzip_;  // decompressor for Packing::gzip
  enum class Packing : std::uint8_t { unknown, plain, gzip };
  Packing packing_ = Packing::unknown;
};

/// Mesh of another program, read when its file is complete.
class MeshContent final : public SceneContent {
 public:
  MeshContent(SceneTarget& target, const ContentType& type)
      : target_(target), type_(type), share_(target.loading().budget, Resource::files) {}

  bool whole_file(const net::MappedFile& file, const std::string&) override {
    read(file.bytes());
    return true;
  }
  void receive(std::span<const std::byte> bytes) override {
    if (!share_.grow(bytes.size())) {
      target_.refuse_size();
      bytes_ = {};
      return;
    }
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void end(bool) override { read(std::exchange(bytes_, {})); }

 private:
  void read(std::span<const std::byte> bytes) {
    Loading& loading = target_.loading();
    const Found& found = target_.found();
    const PhaseScope phase(loading.options.phases, Phase::parse);
    ImportSource source{bytes, found.path, loading.fetcher.reader_of(found.origin), loading.budget,
                        loading.results.diagnostics()};
    source.component = loading.options.component;
    if (!target_.is_root()) source.component.found.reset();
    source.for_x3d = target_.in_x3d();
    source.local = found.local;
    auto scene = import_scene(type_, source, read_confined);
    if (!scene) return target_.refuse();
    target_.replace_scene(std::move(scene));
  }

  SceneTarget& target_;
  const ContentType& type_;
  std::vector<std::byte> bytes_;
  Share share_;  // of `bytes_`
};

/// Vectors, which a Shape of the scene shows.
class VectorContent final : public SceneContent {
 public:
  explicit VectorContent(SceneTarget& target) : target_(target) {
    UrlRequest request;
    request.type = "QNV";
    request.file = target.found().path;
    geometry_ = std::make_shared<GeometryHandler>(
        target.loading(), std::move(request),
        [this](const std::shared_ptr<const qnv::Geometry>& geometry) { show(geometry); });
    geometry_->begin(target.found());
    if (target.is_root()) geometry_->note_datasets();
    geometry_->show_later_at([this] { return ResourceUpdates::Place{target_.scene(), node_}; });
    geometry_->show_flow_by([this](MeshAsset mesh) { show_mesh(std::move(mesh)); });
  }

  bool whole_file(const net::MappedFile& file, const std::string& path) override {
    geometry_->cut = cut;
    (void)geometry_->whole_file(file, path);
    if (!node_ && !is_mesh_) target_.refuse();
    return true;
  }
  void receive(std::span<const std::byte> bytes) override {
    geometry_->cut = cut;
    geometry_->receive(bytes);
  }
  void end(bool damaged) override {
    geometry_->cut = cut || damaged;
    geometry_->end(std::nullopt);
    if (!node_ && !is_mesh_) target_.refuse();
  }
  bool take_parts(const PartsOffer& offer) override {
    const bool taken = geometry_->take_parts(offer);
    note_missing_parts();
    return taken;
  }
  /// Reads a volume by parts. `front` has the first bytes of `file`.
  void read_parts(const std::shared_ptr<PartialFile>& file, std::span<const std::byte> front) {
    geometry_->read_parts(file, front);
    note_missing_parts();
  }
  void receive_piece(const net::CellEvent& event) override { geometry_->receive_piece(event); }
  [[nodiscard]] bool has_more() const override { return node_ && geometry_->has_more(); }
  void read_more() override {
    geometry_->read_more();
    note_missing_parts();
  }
  std::shared_ptr<StreamFeed> feed() override { return geometry_->feed(); }

 private:
  // The exit status of commands reports missing parts.
  void note_missing_parts() {
    if (geometry_->lacks_parts()) target_.cut_short();
  }
  void show(const std::shared_ptr<const qnv::Geometry>& geometry) {
    if (!node_) {
      const Found& found = target_.found();
      const std::string path = found.local ? net::url_of_path(found.path).path : found.url.path;
      node_ = add_geometry_shape(*target_.scene(), *geometry, path.substr(path.rfind('/') + 1));
      if (!node_) return;
      target_.set_up(stated_upright(geometry->description().metadata));
      target_.add_nodes(false);  // its url is this file
    }
    target_.loading().results.add(ResourceUpdates::Geometry{{target_.scene(), node_}, {}, geometry});
  }

  void show_mesh(MeshAsset mesh) {
    Loading& loading = target_.loading();
    auto scene = scene_of(std::move(mesh), target_.found().path, loading.budget, loading.results.diagnostics());
    if (scene->roots().empty()) return;
    is_mesh_ = true;
    target_.replace_scene(std::move(scene));
  }

  SceneTarget& target_;
  std::shared_ptr<GeometryHandler> geometry_;
  vrml::NodeId node_;
  bool is_mesh_ = false;  // vectors are shown as a mesh
};

/// Volume or mesh; the whole file decides.
class DatasetContent final : public SceneContent {
 public:
  DatasetContent(SceneTarget& target, const ContentType& type)
      : target_(target), type_(type), share_(target.loading().budget, Resource::files) {}

  bool whole_file(const net::MappedFile& file, const std::string& path) override {
    choose(file.bytes(), path);
    return content_->whole_file(file, path);
  }
  void receive(std::span<const std::byte> bytes) override {
    if (!share_.grow(bytes.size())) {
      target_.refuse_size();
      bytes_ = {};
      return;
    }
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  bool take_parts(const PartsOffer& offer) override {
    const std::string name = file_name(offer.place.url.path);
    if (!reads_by_parts(name, bytes_)) return false;
    const auto file = std::make_shared<PartialFile>(name, offer, bytes_);
    if (!file->problem().empty()) return false;
    // A mesh needs the whole file.
    const ContentType& type = type_of(bytes_, file->path(), [file](auto parts) { return file->need(parts); });
    if (type.content == ContentClass::mesh) return false;
    target_.set_type(type);
    const std::vector<std::byte> front = std::exchange(bytes_, {});
    share_.shrink_to(0);
    auto content = std::make_unique<VectorContent>(target_);
    content->cut = cut;
    content->read_parts(file, front);
    content_ = std::move(content);
    return true;
  }
  void end(bool damaged) override {
    if (content_) return content_->end(damaged);
    {
      // A child looks into the file before it is read.
      const Found& found = target_.found();
      const TemporaryFile file(file_name(found.local ? found.path : found.url.path), bytes_);
      if (!file.problem().empty()) {
        target_.report(Severity::error, {}, file.problem());
        return target_.refuse();
      }
      choose(bytes_, file.path());
    }
    const std::vector<std::byte> bytes = std::exchange(bytes_, {});
    share_.shrink_to(0);  // the content counts them again
    content_->receive(bytes);
    if (!target_.refused()) content_->end(damaged);
  }
  [[nodiscard]] bool has_more() const override { return content_ && content_->has_more(); }
  void read_more() override { content_->read_more(); }

 private:
  const ContentType& type_of(std::span<const std::byte> bytes, const std::string& path, NeedBytes need = {}) {
    Loading& loading = target_.loading();
    const Found& found = target_.found();
    const ReadFile read_file = loading.fetcher.reader_of(found.origin);
    Diagnostics ignored;  // the content reports problems
    ImportSource source{bytes, path, read_file, loading.budget, ignored};
    source.component = loading.options.component;
    if (!target_.is_root()) source.component.found.reset();
    source.local = true;
    source.need = std::move(need);
    return type_of_content(type_, source);
  }

  void choose(std::span<const std::byte> bytes, const std::string& path) {
    const ContentType& type = type_of(bytes, path);
    target_.set_type(type);
    if (type.content == ContentClass::mesh)
      content_ = std::make_unique<MeshContent>(target_, type);
    else
      content_ = std::make_unique<VectorContent>(target_);
    content_->cut = cut;
  }

  SceneTarget& target_;
  const ContentType& type_;
  std::vector<std::byte> bytes_;
  Share share_;  // of `bytes_`
  std::unique_ptr<SceneContent> content_;
};

/// Stream of outlines.
class OutlineContent final : public SceneContent {
 public:
  explicit OutlineContent(SceneTarget& target) : target_(target), reader_(target.loading(), *target.scene()) {}

  void receive(std::span<const std::byte> bytes) override {
    reader_.receive(bytes);
    show();
  }
  void receive_piece(const net::CellEvent& event) override {
    reader_.receive_piece(event);
    show();
  }
  void end(bool damaged) override {
    reader_.end(target_.found().path, !cut && !damaged);
    show();
    if (reader_.empty()) target_.refuse();
  }

 private:
  void show() {
    target_.set_up(reader_.upright());
    for (const vrml::NodeId id : reader_.take_changed()) target_.node_changed(id);
    target_.add_nodes();  // and their textures
  }

  SceneTarget& target_;
  OutlineReader reader_;
};

}  // namespace

std::unique_ptr<SceneContent> content_for(SceneTarget& target, const ContentType& type,
                                          std::span<const std::byte> first) {
  if (type.content == ContentClass::mesh) return std::make_unique<MeshContent>(target, type);
  if (type.holds_mesh) return std::make_unique<DatasetContent>(target, type);
  if (!type.is_geometry()) return std::make_unique<TextContent>(target, type.grammar);
  if (is_outline_stream(first)) return std::make_unique<OutlineContent>(target);
  return std::make_unique<VectorContent>(target);
}

}  // namespace gs::app
