#include "xplt.h"
#include <gtest/gtest.h>
