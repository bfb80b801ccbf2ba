#include "view/asked/message.h"

#include "base/error.h"
#include "fuzz/corpus_runner.h"

#include <gtest/gtest.h>

#include <string>

extern "C" int fuzzMessage(const std::uint8_t* data, std::size_t size);  // fuzz/message_fuzz.cpp

namespace stratum::view {
namespace {

TEST(Message, EveryKindIsRead) {
    const Message show = parseMessage(R"({"type": "show", "number": 7, "moving": true, "state": {"spp": 4}})");
    EXPECT_EQ(std::get<ShowMessage>(show).number, 7U);
    EXPECT_TRUE(std::get<ShowMessage>(show).moving);
    EXPECT_EQ(std::get<ShowMessage>(show).state.spp, 4);
    const Message inspect = parseMessage(R"({"type": "inspect", "number": 1, "x": 0.25, "y": 1})");
    EXPECT_EQ(std::get<InspectMessage>(inspect).x, 0.25);
    EXPECT_TRUE(std::holds_alternative<SaveMessage>(parseMessage(R"({"type": "save", "state": {}})")));
    EXPECT_TRUE(std::holds_alternative<ShownMessage>(parseMessage(R"({"type": "shown"})")));
    EXPECT_TRUE(std::holds_alternative<MovesMessage>(parseMessage(R"({"type": "moves"})")));
    EXPECT_TRUE(std::holds_alternative<LayersMessage>(parseMessage(R"({"type": "layers"})")));
    EXPECT_EQ(std::get<ProgramMessage>(parseMessage(R"({"type": "program", "bead": 12})")).bead, 12U);
    EXPECT_EQ(std::get<FindMessage>(parseMessage(R"({"type": "find", "text": "M106", "line": 3})")).text, "M106");
    EXPECT_EQ(std::get<FindMessage>(parseMessage(R"({"type": "find", "line": 3})")).line, 3U);
    EXPECT_EQ(std::get<FindMessage>(parseMessage(R"({"type": "find", "seconds": 0})")).seconds, 0.0);
    EXPECT_EQ(std::get<OpenMessage>(parseMessage(R"({"type": "open", "file": 2})")).file, 2U);
}

TEST(Message, OthersAreRefused) {
    for (const char* text : {"",
                             "{",
                             "null",
                             "[]",
                             "{}",
                             R"({"type": "quit"})",
                             R"({"type": 3})",
                             R"({"type": "show"})",
                             R"({"type": "show", "state": {"size": [1, 1]}})",
                             R"({"type": "shown", "more": 1})",
                             R"({"type": "inspect", "x": 2})",
                             R"({"type": "inspect", "y": -1})",
                             R"({"type": "inspect", "number": 1, "x": NaN, "y": 0})",
                             R"({"type": "inspect", "number": 1, "x": 1e308, "y": 0})",
                             R"({"type": "open", "file": -1})",
                             R"({"type": "open", "file": 1e30})",
                             R"({"type": "program"})",
                             R"({"type": "program", "bead": -1})",
                             R"({"type": "program", "bead": 1.5})",
                             R"({"type": "moves", "kind": 1})",
                             R"({"type": "find"})",
                             R"({"type": "find", "seconds": -1})",
                             R"({"type": "find", "line": -1})",
                             R"({"type": "show", "state": {"beads": 0}})",
                             R"({"type": "show", "state": {"beads": 2.5}})",
                             R"({"type": "show", "state": {"beads": 2, "printed": 50}})",
                             R"({"type": "show", "state": {"also": []}})",
                             R"({"type": "show", "number": -1, "state": {}})"}) {
        SCOPED_TRACE(text);
        EXPECT_THROW((void)parseMessage(text), InputError);
    }
    EXPECT_THROW((void)parseMessage(std::string(1000000, '[')), InputError);
    std::string nested;
    for (int n = 0; n < 100000; ++n) nested += "{\"a\":";
    EXPECT_THROW((void)parseMessage(nested), InputError);
    const std::string large = R"({"type": "show", "state": {"material": ")" + std::string(1000000, 'a') + "\"}}";
    EXPECT_THROW((void)parseMessage(large), InputError);
    EXPECT_THROW((void)parseMessage(std::string("{\"type\":\"shown\0\"}", 17)), InputError);
    EXPECT_THROW((void)parseMessage("\xff\xfe"), InputError);
}

TEST(FuzzCorpus, Messages) { EXPECT_GT(test::runFuzzCorpus("message", fuzzMessage), 8U); }

}  // namespace
}  // namespace stratum::view
