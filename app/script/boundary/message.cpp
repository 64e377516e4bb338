#include "app/script/boundary/message.h"

#include <optional>
#include <utility>

namespace gs::app::script {
namespace {

// ---- Nodes, places and types

void write_ref(MessageWriter& to, const NodeRef& node) {
  to.number(node.scene);
  to.number(node.id);
}
NodeRef read_ref(MessageReader& from) {
  NodeRef node;
  node.scene = from.number<std::uint64_t>();
  node.id = from.number<vrml::NodeId>();
  return node;
}

void write_diagnostic(MessageWriter& to, const std::optional<Diagnostic>& one) {
  to.number(static_cast<std::uint8_t>(one.has_value()));
  if (!one) return;
  to.number(static_cast<std::uint32_t>(one->severity));
  to.text(one->file);
  to.number(one->location);
  to.text(one->message);
}
Severity read_severity(MessageReader& from) {
  return static_cast<Severity>(from.below(static_cast<std::uint32_t>(Severity::error) + 1));
}
std::optional<Diagnostic> read_diagnostic(MessageReader& from) {
  if (!from.truth()) return std::nullopt;
  Diagnostic one;
  one.severity = read_severity(from);
  one.file = from.text();
  one.location = from.number<SourceLocation>();
  one.message = from.text();
  return one;
}

/// How a message contains a node type.
enum class TypeForm : std::uint8_t { none, built_in, written };

void write_type(MessageWriter& to, const vrml::NodeType* type) {
  if (!type) return to.number(TypeForm::none);
  const bool is_known =
      type->kind == vrml::NodeType::Kind::built_in && vrml::built_in_node_type(type->language, type->name) == type;
  to.number(is_known ? TypeForm::built_in : TypeForm::written);
  to.number(static_cast<std::uint32_t>(type->language));
  to.text(type->name);
  if (is_known) return;
  to.number(static_cast<std::uint32_t>(type->kind));
  to.number(static_cast<std::uint32_t>(type->role));
  to.number(static_cast<std::uint64_t>(type->interfaces.size()));
  for (const vrml::InterfaceDeclaration& one : type->interfaces) {
    to.number(static_cast<std::uint32_t>(one.access));
    to.number(static_cast<std::uint32_t>(one.type));
    to.text(one.name);
    to.text(one.x3d_name);
    to.text(one.former_name);
  }
}

std::shared_ptr<const vrml::NodeType> read_type(MessageReader& from) {
  constexpr std::size_t kLeastInterface = 5 * sizeof(std::uint32_t);
  const auto form = from.number<TypeForm>();
  if (form == TypeForm::none) return nullptr;
  const auto language = static_cast<vrml::Language>(from.below(static_cast<std::uint32_t>(vrml::Language::x3d) + 1));
  std::string name = from.text();
  if (form == TypeForm::built_in) {
    const vrml::NodeType* const known = from.good() ? vrml::built_in_node_type(language, name) : nullptr;
    if (!known) from.fail();
    return {std::shared_ptr<const vrml::NodeType>(), known};
  }
  if (form != TypeForm::written) from.fail();
  auto type = std::make_shared<vrml::NodeType>();
  type->language = language;
  type->name = std::move(name);
  type->kind = static_cast<vrml::NodeType::Kind>(
      from.below(static_cast<std::uint32_t>(vrml::NodeType::Kind::external_prototype) + 1));
  type->role = static_cast<vrml::Role>(from.number<std::uint32_t>());
  const std::size_t count = from.count(kLeastInterface);
  for (std::size_t i = 0; i < count && from.good(); ++i) {
    vrml::InterfaceDeclaration one;
    one.access =
        static_cast<vrml::AccessType>(from.below(static_cast<std::uint32_t>(vrml::AccessType::exposedField) + 1));
    one.type = static_cast<vrml::FieldType>(from.below(vrml::kFieldTypeCount));
    one.name = from.text();
    one.x3d_name = from.text();
    one.former_name = from.text();
    if (from.good()) type->declare(std::move(one));
  }
  return type;
}

void write_values(MessageWriter& to, const std::vector<std::pair<std::uint32_t, vrml::FieldValue>>& values) {
  to.number(static_cast<std::uint64_t>(values.size()));
  for (const auto& [place, value] : values) {
    to.number(place);
    write(to, value);
  }
}

void write_facts(MessageWriter& to, const ProgramFacts* facts) {
  to.number(static_cast<std::uint8_t>(facts != nullptr));
  if (!facts) return;
  write_ref(to, facts->node);
  write_type(to, facts->type.get());
  to.number(static_cast<std::uint32_t>(facts->language));
  to.text(facts->library);
  to.text(facts->late_message);
  to.number(static_cast<std::int32_t>(facts->faults));
}
std::shared_ptr<const ProgramFacts> read_facts(MessageReader& from) {
  if (!from.truth()) return nullptr;
  auto facts = std::make_shared<ProgramFacts>();
  facts->node = read_ref(from);
  facts->type = read_type(from);
  facts->language = static_cast<vrml::Language>(from.below(static_cast<std::uint32_t>(vrml::Language::x3d) + 1));
  facts->library = from.text();
  facts->late_message = from.text();
  facts->faults = from.number<std::int32_t>();
  return facts;
}

void write_browser(MessageWriter& to, const BrowserFacts* facts) {
  to.number(static_cast<std::uint8_t>(facts != nullptr));
  if (!facts) return;
  for (const double number : {facts->speed, facts->frame_rate, facts->start_time, facts->width, facts->height})
    to.number(number);
  to.number(facts->position);
  to.number(facts->orientation);
  for (const bool setting : facts->settings) to.number(static_cast<std::uint8_t>(setting));
  to.number(facts->event_mask);
  to.text(facts->world_url);
  to.text(facts->base_url);
  to.text(facts->mode);
}
std::shared_ptr<const BrowserFacts> read_browser(MessageReader& from) {
  if (!from.truth()) return nullptr;
  auto facts = std::make_shared<BrowserFacts>();
  for (double* const number : {&facts->speed, &facts->frame_rate, &facts->start_time, &facts->width, &facts->height})
    *number = from.number<double>();
  facts->position = from.number<std::array<double, 3>>();
  facts->orientation = from.number<std::array<double, 4>>();
  for (bool& setting : facts->settings) setting = from.truth();
  facts->event_mask = from.number<std::int32_t>();
  facts->world_url = from.text();
  facts->base_url = from.text();
  facts->mode = from.text();
  return facts;
}

}  // namespace

// ---- Items

void write(MessageWriter& to, const Order& order) {
  to.begin(ItemKind::order);
  to.number(static_cast<std::uint32_t>(order.kind));
  to.number(order.program);
  to.number(order.place);
  write(to, order.value);
  to.number(order.time);
  to.text(order.text);
  to.text(order.file);
  to.number(order.at);
  write_facts(to, order.facts.get());
  write_values(to, order.values);
  to.number(static_cast<std::uint64_t>(order.gone.size()));
  for (const std::uint64_t scene : order.gone) to.number(scene);
  to.number(order.now);
  to.number(order.seconds);
  to.number(static_cast<std::uint64_t>(order.heap));
  to.number(static_cast<std::uint64_t>(order.image_pixels));
}

Order read_order(MessageReader& from) {
  constexpr std::size_t kLeastValue = sizeof(std::uint32_t) + 2;
  Order order;
  order.kind = static_cast<Order::Kind>(from.below(kOrderCount));
  order.program = from.number<vrml::EventNode>();
  order.place = from.number<std::uint32_t>();
  order.value = read_value(from);
  order.time = from.number<double>();
  order.text = from.text();
  order.file = from.text();
  order.at = from.number<SourceLocation>();
  order.facts = read_facts(from);
  const std::size_t values = from.count(kLeastValue);
  for (std::size_t i = 0; i < values && from.good(); ++i) {
    const auto place = from.number<std::uint32_t>();
    order.values.emplace_back(place, read_value(from));
  }
  const std::size_t gone = from.count(sizeof(std::uint64_t));
  for (std::size_t i = 0; i < gone; ++i) order.gone.push_back(from.number<std::uint64_t>());
  order.now = from.number<double>();
  order.seconds = from.number<double>();
  order.heap = static_cast<std::size_t>(from.number<std::uint64_t>());
  order.image_pixels = static_cast<std::size_t>(from.number<std::uint64_t>());
  return order;
}

void write(MessageWriter& to, const Answer& answer) {
  to.begin(ItemKind::answer);
  to.number(static_cast<std::uint8_t>(answer.good));
  to.number(static_cast<std::uint8_t>(answer.flag));
  write_ref(to, answer.node);
  to.number(answer.place);
  to.text(answer.text);
  write(to, answer.value);
  to.number(static_cast<std::uint64_t>(answer.items.size()));
  for (const AnswerItem& item : answer.items) {
    to.number(static_cast<std::uint8_t>(item.index()));
    if (const auto* const number = std::get_if<double>(&item)) to.number(*number);
    if (const auto* const text = std::get_if<std::string>(&item)) to.text(*text);
    if (const auto* const node = std::get_if<NodeRef>(&item)) write_ref(to, *node);
  }
  write_type(to, answer.type.get());
  write_browser(to, answer.browser.get());
}

Answer read_answer(MessageReader& from) {
  constexpr std::size_t kLeastItem = 1 + sizeof(std::uint32_t);
  Answer answer;
  answer.good = from.truth();
  answer.flag = from.truth();
  answer.node = read_ref(from);
  answer.place = from.number<std::uint32_t>();
  answer.text = from.text();
  answer.value = read_value(from);
  const std::size_t items = from.count(kLeastItem);
  for (std::size_t i = 0; i < items && from.good(); ++i) {
    switch (from.number<std::uint8_t>()) {
      case 0:
        answer.items.emplace_back(from.number<double>());
        break;
      case 1:
        answer.items.emplace_back(from.text());
        break;
      case 2:
        answer.items.emplace_back(read_ref(from));
        break;
      default:
        from.fail();
    }
  }
  answer.type = read_type(from);
  answer.browser = read_browser(from);
  return answer;
}

void write(MessageWriter& to, const Notice& notice) {
  to.begin(ItemKind::notice);
  to.number(static_cast<std::uint32_t>(notice.kind));
  switch (notice.kind) {
    case Notice::Kind::hold:
    case Notice::Kind::release:
      return write_ref(to, notice.node);
    case Notice::Kind::print:
      return to.text(notice.text);
    case Notice::Kind::report:
      to.number(static_cast<std::uint32_t>(notice.severity));
      to.text(notice.text);
      return write_diagnostic(to, notice.at);
    case Notice::Kind::direct_output:
      return;
    case Notice::Kind::post:
      write_ref(to, notice.node);
      [[fallthrough]];
    case Notice::Kind::own_value:
      to.number(notice.place);
      return write(to, notice.value);
    case Notice::Kind::send_own:
      return to.number(notice.place);
  }
}

Notice read_notice(MessageReader& from) {
  Notice notice;
  notice.kind = static_cast<Notice::Kind>(from.below(kNoticeCount));
  switch (notice.kind) {
    case Notice::Kind::hold:
    case Notice::Kind::release:
      notice.node = read_ref(from);
      break;
    case Notice::Kind::print:
      notice.text = from.text();
      break;
    case Notice::Kind::report:
      notice.severity = read_severity(from);
      notice.text = from.text();
      notice.at = read_diagnostic(from);
      break;
    case Notice::Kind::direct_output:
      break;
    case Notice::Kind::post:
      notice.node = read_ref(from);
      [[fallthrough]];
    case Notice::Kind::own_value:
      notice.place = from.number<std::uint32_t>();
      notice.value = read_value(from);
      break;
    case Notice::Kind::send_own:
      notice.place = from.number<std::uint32_t>();
      break;
  }
  return notice;
}

void write(MessageWriter& to, const Question& question) {
  to.begin(ItemKind::question);
  to.number(static_cast<std::uint32_t>(question.ask));
  write_ref(to, question.node);
  write_ref(to, question.other);
  to.number(question.place);
  to.number(static_cast<std::uint8_t>(question.flag));
  to.text(question.text);
  to.text(question.more);
  write(to, question.value);
  write(to, question.second);
}

Question read_question(MessageReader& from) {
  Question question;
  question.ask = static_cast<Ask>(from.below(kAskCount));
  question.node = read_ref(from);
  question.other = read_ref(from);
  question.place = from.number<std::uint32_t>();
  question.flag = from.truth();
  question.text = from.text();
  question.more = from.text();
  question.value = read_value(from);
  question.second = read_value(from);
  return question;
}

void write(MessageWriter& to, const Report& report) {
  to.begin(ItemKind::report);
  for (const bool flag : {report.good, report.no_memory, report.runs, report.off, report.has_processed,
                          report.has_prepare, report.skipped})
    to.number(static_cast<std::uint8_t>(flag));
  to.number(report.seconds);
  to.number(static_cast<std::int32_t>(report.faults));
  to.text(report.text);
  write_diagnostic(to, report.problem);
}

Report read_report(MessageReader& from) {
  Report report;
  for (bool* const flag : {&report.good, &report.no_memory, &report.runs, &report.off, &report.has_processed,
                           &report.has_prepare, &report.skipped})
    *flag = from.truth();
  report.seconds = from.number<double>();
  report.faults = from.number<std::int32_t>();
  report.text = from.text();
  report.problem = read_diagnostic(from);
  return report;
}

}  // namespace gs::app::script
