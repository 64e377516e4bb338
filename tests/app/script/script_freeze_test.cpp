// Tests of single engine calls that would run for seconds or use gigabytes: each is rejected or short.
#include "app/script/bounds/block_limit.h"
#include "app/script/bounds/bounded_natives.h"
#include "scripts.h"

#include <sys/resource.h>

#include <ctime>

namespace gs::app::script_freeze_test {

using scripts::Lines;
using scripts::run;
using scripts::value;
using scripts::World;

namespace {

double processor_seconds() {
  timespec now{};
  (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

std::size_t peak_mebibytes() {
  rusage used{};
  (void)getrusage(RUSAGE_SELF, &used);
  return static_cast<std::size_t>(used.ru_maxrss) >> 10;
}

/// Result of a program: its messages, and the processor time of its call.
struct Outcome {
  Lines printed, problems;
  double seconds = 0;
};

Outcome outcome_of(const std::string& program, const std::string& interface = {}) {
  Limits limits;
  limits.script_seconds = 100;  // so a call that checks the time is no fault here
  World world("DEF S Script { directOutput TRUE " + interface +
                  " url \"javascript: function big(n, c) { var s = c; for (var i = 0; i < n; ++i) s += s; return s } "
                  "function initialize() { " +
                  program + " }\" }",
              limits);
  const double began = processor_seconds();
  world.start();
  return {world.printed(), world.problems(), processor_seconds() - began};
}

}  // namespace

TEST_CASE("rejects native calls with long strings before they take long") {
  for (const std::string expression :
       {"big(27, 'a').indexOf(big(26, 'a') + 'b')",
        "big(24, 'a').indexOf(big(23, 'a') + 'b')",
        "big(24, 'a').lastIndexOf(big(23, 'a') + 'b')",
        "big(24, 'a').includes(big(23, 'a') + 'b')",
        "big(24, 'a').split(big(23, 'a') + 'b')",
        "big(24, 'a').replace(big(23, 'a') + 'b', 'x')",
        "big(24, 'a').replaceAll(big(23, 'a') + 'b', 'x')",
        "big(22, 'a').replaceAll('a', '$`')",
        "big(24, 'a').match(big(13, 'a') + 'b')",
        "big(24, 'a').search(big(13, 'a') + 'b')",
        "new RegExp(big(13, 'a') + 'b').test(big(24, 'a'))",
        "'x'.indexOf.call({ toString: function () { return big(24, 'a') } }, { toString: function () { return big(23, "
        "'a') "
        "+ 'b' } })",
        "big(24, '\\u0101').normalize('NFD')",
        "('a' + big(20, '\\u0300\\u0316')).normalize('NFC')",
        "('a' + big(12, '\\u0300\\u0316') + 'b').repeat(300).normalize('NFC')",
        "('a' + big(16, '\\u0300\\u0316')).localeCompare('a' + big(16, '\\u0316\\u0300'))",
        "big(24, '\\u03a3').toLowerCase()",
        "JSON.parse(big(22, '['))",
        "JSON.parse('[0.' + big(20, '1') + ']')",
        "JSON.parse('[' + big(20, '[],') + '1]')",
        "new RegExp(big(18, '(?=a)')).test('b')",
        "new RegExp({ source: big(18, '(?=a)'), flags: '', [Symbol.match]: true }).test('b')",
        "new RegExp(big(12, '.'), 'iu').test('b')",
        "new RegExp(big(11, '[^\\\\\\\\P{L}]'), 'iu').exec('b')",
        "eval(big(22, 'a=1;'))",
        "eval('0.' + big(20, '1'))",
        "new Function(big(22, 'a=1;'))()",
        "eval('1n << 1000000n').toString()",
        "Object.keys(big(22, 'a'))",
        "Object.entries(new String(big(22, 'a')))",
        "(function () { var a = []; for (var i = 0; i < 4; ++i) { var s = big(24, 'a') + i; s[0]; for (var k = 0; k < "
        "1000; ++k) a.push(s) } return a.indexOf(big(24, 'a') + 9) })()"}) {
    INFO(expression);
    const Outcome outcome =
        outcome_of("var failed = false; try { " + expression + " } catch (e) { failed = true } print(failed);");
    CHECK(outcome.printed == Lines{"true"});
    CHECK(outcome.problems == Lines{});
    CHECK(outcome.seconds < 1.5);
  }
}

TEST_CASE("throws on operators with strings that are too long to flatten") {
  for (const std::string statement :
       {"big(29, 'a')[0]", "big(29, 'a') === big(29, 'a') + ''", "({})[big(29, 'a')] = 1", "+big(29, '1')",
        "for (var k in new String(big(22, 'a')));", "var o = { ...big(22, 'a') }"}) {
    INFO(statement);
    const Outcome outcome =
        outcome_of("var failed = false; try { " + statement + " } catch (e) { failed = true } print(failed);");
    CHECK(outcome.printed == Lines{"true"});
    CHECK(outcome.seconds < 1.5);
  }
}

TEST_CASE("rejects a program with an overlong number or with BigInt") {
  const Outcome number = outcome_of("var x = 0." + std::string(100'000, '1') + ";");
  REQUIRE(number.problems.size() == 1);
  CHECK(number.problems.front().find("RangeError: a number has 100002 characters; the limit is 65536") !=
        std::string::npos);
  const Outcome integer = outcome_of("var x = 1n << 5n;");
  REQUIRE(integer.problems.size() == 1);
  CHECK(integer.problems.front().find("literals of BigInt (such as 1n) are not available in Scripts") !=
        std::string::npos);
  CHECK(outcome_of("print('2n' + /1n/.source); /* 3n */").printed == Lines{"2n1n"});
  CHECK(value("typeof BigInt") == "undefined");
}

TEST_CASE("keeps bounded built-in functions unchanged for short texts") {
  CHECK(value("'abcabc'.indexOf('c', 3) + ' ' + 'abcabc'.lastIndexOf('b') + ' ' + 'undefined'.indexOf()") == "5 4 0");
  CHECK(value("'a,b;c'.split(/[,;]/).join('|') + 'a-b'.split('-', 1) + 'abc'.split('')") == "a|b|caa,b,c");
  CHECK(value("'aXbX'.replace('X', function (m, i) { return m + i }) + 'aaa'.replaceAll('a', '<$&>') + "
              "'a1b22'.replace(/([0-9]+)/g, '($1)')") == "aX1bX<a><a><a>a(1)b(22)");
  CHECK(value("'a1b2'.match(/[0-9]/g) + ' ' + 'a1'.match('[0-9]').index + ' ' + 'ab'.search('b') + ' ' + "
              "Array.from('a1b2'.matchAll(/[0-9]/g)).length") == "1,2 1 1 2");
  CHECK(value("'e\\u0301'.normalize().length + ' ' + 'a'.localeCompare('b') + ' ' + 'Ab'.toLowerCase()") == "1 -1 ab");
  CHECK(value("[1, 2, 'x'].indexOf('x') + ' ' + [1, 2].includes(2) + ' ' + JSON.parse('[1,[2.5]]')[1]") ==
        "2 true 2.5");
  CHECK(value("'x'.indexOf.name + 'x'.indexOf.length + ('' + 'x'.indexOf).indexOf('[native code]')") == "indexOf125");
  CHECK(
      value("(new RegExp('a+', 'g') instanceof RegExp) + ' ' + (/a/.constructor === RegExp) + ' ' + RegExp(/b/i).flags "
            "+ ' ' + RegExp.name + RegExp.length") == "true true i RegExp2");
  CHECK(value("/(b)(c)/.exec('abc').index + RegExp.$1 + RegExp.$2 + RegExp.lastMatch") == "1bcbc");
  CHECK(value("(function () { var a = /x/; return RegExp(a) === a })()") == "true");
  CHECK(value("(function () { try { 'a'.includes(/a/) } catch (e) { return e.name } })()") == "TypeError");
  CHECK(value("(function () { try { 'a'.replaceAll(/a/, 'b') } catch (e) { return e.name } })()") == "TypeError");
  CHECK(value("(function () { try { String.prototype.indexOf.call(null) } catch (e) { return e.name } })()") ==
        "TypeError");
  CHECK(value("(function () { try { 'a'.repeat(1 << 26).toLowerCase() } catch (e) { return e.name + ': ' + e.message } "
              "})()") == "RangeError: a text has 67108864 characters; the limit is 4194304");
  CHECK(value("eval('1 + 1') + Function('a', 'return a * 2')(4)") == "10");
  CHECK(value("(function () { class R extends RegExp { test(s) { return !super.test(s) } } return new R('a').test('b') "
              "})()") == "true");
}

TEST_CASE("applies the limit of single blocks to the engine's allocations") {
  CHECK(script::BlockLimit::install());
  const Outcome outcome =
      outcome_of("var s = big(23, 'a'); s[0]; print(s.length); s = big(27, 'a'); s[0]; print('no');");
  CHECK(outcome.printed == Lines{"8388608"});
  REQUIRE(outcome.problems.size() == 1);
  CHECK(outcome.problems.front().find("exceeds the memory limit") != std::string::npos);
}

TEST_CASE("cuts or rejects long arguments of browser functions before copying them") {
  const std::string interface =
      "field MFString texts [] field SFString text \"\" field SFNode t Text { } eventOut MFString out ";
  const std::size_t before = peak_mebibytes();
  for (const std::string program :
       {"var s = big(28, 'a'); print(s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, "
        "s, "
        "s, s, s, s, s, s, s, s, s, s, s, s);",
        "var s = big(24, 'a'); print(s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s, "
        "s, "
        "s, s, s, s, s, s, s, s, s, s, s, s);",
        "var a = []; for (var i = 0; i < 40; ++i) a.push(big(28, 'a')); Browser.loadURL(a, a);",
        "var a = []; for (var i = 0; i < 40; ++i) a.push(big(24, 'a')); Browser.loadURL(a, a);",
        "var a = []; for (var i = 0; i < 40; ++i) a.push(big(20, 'a')); for (i = 0; i < 10; ++i) Browser.loadURL(a, "
        "a);",
        "for (var i = 0; i < 20; ++i) Browser.setDescription(big(24, 'a'));",
        "Browser.createVrmlFromString(big(28, ' '));", "Browser.createVrmlFromString(big(20, 'Group{} '));",
        "for (var i = 0; i < 4000; ++i) texts[i] = big(20, 'a') + i;",
        "var m = new MFString(); for (var i = 0; i < 4000; ++i) m[i] = big(20, 'a') + i;",
        "for (var i = 0; i < 400; ++i) { var m = new MFString(big(22, 'a') + i); keep = [m, i > 0 ? keep : 0] }",
        "for (var i = 0; i < 10; ++i) text = big(24, 'a');",
        "var a = []; for (var i = 0; i < 4000; ++i) a.push(big(20, 'a')); texts = a;"}) {
    INFO(program);
    (void)outcome_of("var keep; " + program, interface);
  }
  INFO(before << " MiB before");
  CHECK(peak_mebibytes() < before + 600);
}

TEST_CASE("charges the texts of a list to the heap of programs") {
  const std::string interface = "field MFString texts [] ";
  Limits limits;
  limits.script_heap = std::size_t{16} << 20;
  limits.script_seconds = 100;
  for (const std::string list : {"texts", "new MFString()"}) {
    World world("DEF S Script { " + interface +
                    "url \"javascript: function initialize() { var s = 'a'.repeat(1 << 20), m = " + list +
                    "; for (var i = 0; i < 20; ++i) { m[0] = s; m[1] = s } print('replaced'); for (i = 0; i < 64; ++i) "
                    "m[i] = s; print('no'); }\" }",
                limits);
    world.start();
    CHECK(world.printed() == Lines{"replaced"});
    const Lines problems = world.problems();
    REQUIRE(problems.size() == 1);
    CHECK(problems.front().find("the program exceeds the") != std::string::npos);
  }
}

TEST_CASE("reports an overdue program from another thread") {
  std::string reported;
  ScriptRunner::on_overdue([&](const std::string& message) { reported = message; });
  Limits limits;
  limits.script_seconds = 0.1;
  // Parsing this number takes seconds inside one operator.
  World world("DEF S Script { url \"javascript: function initialize() { print(+('0.' + '1'.repeat(300000)) > 0); }\" }",
              limits);
  world.start();
  ScriptRunner::on_overdue(nullptr);
  CHECK(reported == "text.wrl:2:7: error: Script S: the program exceeded the time limit");
  CHECK(world.problems().size() == 1);
}

}  // namespace gs::app::script_freeze_test
