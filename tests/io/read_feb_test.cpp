#include "read_feb.h"
#include <gtest/gtest.h>
