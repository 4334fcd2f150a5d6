"""Tell people of alarms and of their ends, each once; a message that could not be sent waits for the next call.

Notices (what there is to tell now) -> messages (what a channel has not been told yet) -> outbox -> delivery.
"""
