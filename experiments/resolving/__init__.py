"""Does the recording that `greybox design` asks for decide what earlier ones left open?"""
