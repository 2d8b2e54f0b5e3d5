#include "read_feb.h"
