// Fields of JSON documents: what is absent, what is wrong and how errors name it.
#include "base/json_fields.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/temporary_folder.h"

namespace relamp {
namespace {

TEST(JsonFields, GivesValuesAndFallbacks) {
    const Json document = parseJson(R"({"name": "key", "on": true, "count": 3, "seed": 9223372036854775808,
        "size": 0.5, "place": [1, 2, 1e9], "nothing": null, "spectrum": [1, "x", 0.25]})");
    const JsonFields f(document);
    EXPECT_EQ(f.get<std::string>("name"), "key");
    EXPECT_TRUE(f.get("on", false));
    EXPECT_EQ(f.get("count", 0), 3);
    EXPECT_EQ(f.get("seed", uint64_t(0)), uint64_t(1) << 63);
    EXPECT_EQ(f.get("size", 1.0f), 0.5f);
    EXPECT_EQ(f.get<DVec3>("place"), DVec3(1, 2, 1e9));
    EXPECT_EQ(f.get("absent", 7), 7);
    EXPECT_EQ(f.get("nothing", 0.25), 0.25) << "null counts as absent";
    EXPECT_FALSE(f.has("nothing"));
    EXPECT_EQ(f.numbers("spectrum"), (std::vector<float>{1, 0.25f}));
    EXPECT_TRUE(f.list("absent").empty());
    EXPECT_EQ(f.object("absent").get("x", 5), 5);
}

TEST(JsonFields, ErrorsNameTheField) {
    const Json document = parseJson(R"({"emitters": [{"id": 1}, {"count": -1, "big": 1e12, "place": [1, 2],
        "far": [1e300, 0, 0], "deep": {"list": [{}, 5]}}], "gauge": [], "on": 1})");
    const JsonFields f(document);
    const JsonFields first = f.list("emitters").at(0), second = f.list("emitters").at(1);
    const auto message = [](auto&& read) { return test::messageOf(read); };
    EXPECT_EQ(message([&] { first.get<std::string>("id"); }), "emitters[0].id: expected a text");
    EXPECT_EQ(message([&] { first.get<Vec3>("radiance"); }), "emitters[0].radiance: is missing");
    EXPECT_EQ(message([&] { second.get("count", 0); }), "emitters[1].count: is -1, which is out of range");
    EXPECT_EQ(message([&] { second.get("big", 0); }), "emitters[1].big: is 1e+12, which is out of range");
    EXPECT_EQ(message([&] { second.get("place", Vec3(0)); }), "emitters[1].place: expected three numbers");
    EXPECT_EQ(message([&] { second.get("far", Vec3(0)); }),
              "emitters[1].far[0]: is 1e+300, which is too large; expected at most 3.40282e+38");
    EXPECT_EQ(message([&] { second.object("deep").list("list"); }), "emitters[1].deep.list[1]: expected an object");
    EXPECT_EQ(message([&] { f.object("gauge"); }), "gauge: expected an object");
    EXPECT_EQ(message([&] { f.list("on"); }), "on: expected a list");
    EXPECT_EQ(message([&] { f.get("on", false); }), "on: expected true or false");
}

TEST(JsonFields, DocumentsAreParsedAndWritten) {
    EXPECT_EQ(dumpJson(parseJson("{\"b\": 1, \"a\": [2, null]}")), "{\"a\":[2,null],\"b\":1}");
    EXPECT_EQ(dumpJson(parseJson("{\"a\": 1}"), 1), "{\n \"a\": 1\n}");
    EXPECT_NE(test::messageOf([] {
                  parseJson("{\n \"a\" 1}", "edits.json");
              }).find("edits.json: is not valid JSON (parse error at line 2, column 6"),
              std::string::npos);
    EXPECT_EQ(test::messageOf([] { parseJson("{"); }).find("is not valid JSON (parse error at line 1"), 0u);
    EXPECT_NE(test::messageOf([] { parseJson(std::string(40, '[')); }).find("deeper than 32"), std::string::npos);
    const Json notUtf8 = std::string("a\xff");
    EXPECT_NE(test::messageOf([&] { dumpJson(notUtf8); }).find("not UTF-8"), std::string::npos);
    EXPECT_EQ(dumpJson(notUtf8, -1, BadText::replace), "\"a\xEF\xBF\xBD\"");
}

}  // namespace
}  // namespace relamp
